// Makes engines and renders logs beside the page, so that neither drawing nor sound waits.
import { prepare, renderLog } from './engine.js';

self.onmessage = ({ data: { id, module, make, render } }) => {
  try {
    const answer = make ? prepare(module, make) : renderLog(module, render);
    const moved = [answer.image, answer.audio, answer.haptic, answer.relief?.heights].filter(Boolean).map((bytes) => bytes.buffer);
    self.postMessage({ id, answer }, moved);
  } catch (error) {
    self.postMessage({ id, error: error.message });
  }
};
