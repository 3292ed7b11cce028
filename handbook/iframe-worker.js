// The search runs in a worker, which browsers refuse to pages opened from a disk: there its script runs in a hidden
// frame instead. The theme's own shim for this is fetched from the network; this one comes with the site.
if (location.protocol === "file:") {
  window.IFrameWorker = class extends EventTarget {
    constructor(url) {
      super();
      this.frame = Object.assign(document.createElement("iframe"), { hidden: true });
      document.body.appendChild(this.frame);
      const inside = this.frame.contentWindow;
      window.addEventListener("message", (event) => {
        if (event.source === inside) this.dispatchEvent(new MessageEvent("message", { data: event.data }));
      });
      const script = `
        postMessage = (data) => parent.postMessage(data, "*");
        importScripts = (...urls) => urls.reduce((before, url) => before.then(() => new Promise((done, failed) => {
          document.body.appendChild(Object.assign(document.createElement("script"), { src: url, onload: done, onerror: failed }));
        })), Promise.resolve());`;
      inside.document.open();
      inside.document.write(`<!doctype html><body><script>${script}</` + `script><script src="${url}"></` + `script></body>`);
      inside.document.close();
      this.ready = new Promise((done) => inside.addEventListener("load", done));
    }
    postMessage(data) {
      // Not by the frame's postMessage: that is the worker's own now, which leads here.
      this.ready.then(() => this.frame.contentWindow.dispatchEvent(new MessageEvent("message", { data })));
    }
    terminate() {
      this.frame.remove();
    }
  };
  window.Worker = window.IFrameWorker;
}
