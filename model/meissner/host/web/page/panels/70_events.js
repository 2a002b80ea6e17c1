// What happened, the newest first.
import {make, page, panel} from "/page.js";

const SHOWN = 60;
let body, last = null;

panel({
  id: "events", title: "Events",
  build(found) { body = found; body.className = "events"; body.tabIndex = 0; },
  draw() {
    const seen = page.events.filter(one => one.t <= page.to).slice(-SHOWN), newest = seen.at(-1);
    if (newest === last && body.childElementCount) return;
    last = newest;
    if (!seen.length) return body.replaceChildren(make("p", {className: "note", textContent: "nothing yet"}));
    body.replaceChildren(make("table", {}, ...seen.reverse().map(({t, text, state}) => {
      const what = make("td", {textContent: text});
      if (state !== undefined) {
        const dot = make("span", {className: "dot"});
        dot.style.background = `var(--${["none", "contact", "incipient", "gross", "release"][state] ?? "none"})`;
        what.prepend(dot);
      }
      return make("tr", {}, make("th", {textContent: `${t.toFixed(3)} s`}), what);
    })));
  },
});
