// What the theme's search needs besides. Loaded before the theme's own script, which takes __search and Worker from here.
(() => {
  const base = new URL(".", document.currentScript.src)

  // A page that was opened as a file may neither read another file nor start a worker: the index comes as a script, and the worker's
  // script runs in a frame that is not shown.
  class InFrame extends EventTarget {
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
  if (location.protocol === "file:") {
    window.__search = {
      index: new Promise((resolve) => {
        window.site_index = resolve
        const script = document.createElement("script")
        script.src = new URL("search/index.js", base)
        document.head.append(script)
      }),
    }
  }

  // The theme sends one message at a time and drops all but the last of those that wait. Who types before the index is there could so
  // make it drop the index. What is asked that early is answered at once with nothing; the theme asks again when the index is there.
  const [SETUP_DONE, QUERY, RESULT] = [1, 2, 3]
  window.Worker = class extends (location.protocol === "file:" ? InFrame : Worker) {
    constructor(url) {
      super(url)
      this.addEventListener("message", ({ data }) => (this.ready ||= data.type === SETUP_DONE))
    }
    postMessage(data) {
      if (this.ready || data.type !== QUERY) return super.postMessage(data)
      setTimeout(() => this.dispatchEvent(new MessageEvent("message", { data: { type: RESULT, data: { items: [] } } })))
    }
  }
})()
