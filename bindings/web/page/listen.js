// Hands what a microphone hears to the page, as it is.
registerProcessor('listen', class extends AudioWorkletProcessor {
  process([[samples]]) {
    if (samples) this.port.postMessage(samples.slice());
    return true;
  }
});
