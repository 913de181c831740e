// Search without a server. A page that was opened as a file may neither read another file nor start a worker: the index
// comes as a script, and the worker's script runs in a frame that is not shown.
(() => {
  const base = new URL(".", document.currentScript.src)
  window.__search = {
    index: new Promise((resolve) => {
      window.site_index = resolve
      const script = document.createElement("script")
      script.src = new URL("search/index.js", base)
      document.head.append(script)
    }),
  }
  window.Worker = class extends EventTarget {
    constructor(url) {
      super()
      this.waiting = []
      const start = () => {
        const frame = document.createElement("iframe")
        frame.hidden = true
        document.body.append(frame)
        const inside = frame.contentWindow
        inside.postMessage = (data) => this.dispatchEvent(new MessageEvent("message", { data }))
        const script = frame.contentDocument.createElement("script")
        script.src = url
        script.onload = () => {
          this.frame = inside
          this.waiting.splice(0).forEach((data) => this.postMessage(data))
        }
        frame.contentDocument.body.append(script)
      }
      if (document.body) start()
      else addEventListener("DOMContentLoaded", start)
    }
    postMessage(data) {
      if (this.frame) this.frame.dispatchEvent(new this.frame.MessageEvent("message", { data }))
      else this.waiting.push(data)
    }
    terminate() {}
  }
})()
