// Makes engines, renders logs and does the offline tools' work beside the page, so that neither drawing nor sound waits.
import { prepare, renderLog } from './engine.js';

async function work({ module, make, render, fit, photo, solve }) {
  if (make) return prepare(module, make);
  if (render) return renderLog(module, render);
  if (solve) return (await import('./shape.js')).solve(module, solve);
  const tools = await import('./tools.js');
  return fit ? tools.fit(module, fit) : tools.photo(module, photo);
}

self.onmessage = async ({ data: { id, ...asked } }) => {
  try {
    const answer = await work(asked);
    const moved = [answer.image, answer.audio, answer.haptic, answer.relief?.heights].filter(Boolean).map((bytes) => bytes.buffer);
    self.postMessage({ id, answer }, moved);
  } catch (error) {
    // Where the tools themselves stop, a sentence is better than an address in them.
    const message = error instanceof WebAssembly.RuntimeError ? 'could not be understood; try another one' : error.message;
    self.postMessage({ id, error: message });
  }
};
