// States as bands over time, those that changed last first.
import {canvas, channelName, css, make, page, panel, stateColour, stateName} from "/page.js";

const MOST = 8, TALL = 22, LEFT = 48;
let bands, legend, sub;

panel({
  id: "states", title: "States", shape: "wide",
  shown: () => page.states.of.size > 0,
  build(body, title) {
    sub = title.appendChild(make("small"));
    bands = canvas(body, TALL);
    bands.element.setAttribute("role", "img");
    legend = body.appendChild(make("div", {className: "legend"}));
  },
  begin(hello) {
    legend.replaceChildren(...hello.state_names.map((name, k) => {
      const dot = make("span", {className: "dot"});
      dot.style.background = `var(--${name})`;
      return make("span", {}, dot, name);
    }));
  },
  draw() {
    const changed = [...page.states.of].map(([key, list]) => [key, list.at(-1).t, list.at(-1).value.state]);
    const slipping = changed.filter(([, , state]) => state === 2 || state === 3).length;
    const chosen = changed.sort((a, b) => (b[0] === page.channel) - (a[0] === page.channel) || b[1] - a[1] || a[0] - b[0]).slice(0, MOST).map(([key]) => key).sort((a, b) => a - b);
    sub.textContent = `${changed.filter(([, , state]) => state > 0 && state < 4).length} in contact, ${slipping} slipping${changed.length > MOST ? `; ${MOST} of ${changed.length} channels` : ""}`;
    const [draw, wide] = bands.begin(TALL * chosen.length + 18), room = wide - LEFT, from = page.from, span = page.to - from;
    const x = t => LEFT + Math.max(0, Math.min(1, (t - from) / span)) * room;
    draw.font = "12px system-ui, sans-serif"; draw.textBaseline = "middle";
    chosen.forEach((key, row) => {
      const list = page.states.of.get(key), y = row * TALL;
      draw.fillStyle = css("soft"); draw.fillText(channelName(key), 4, y + TALL / 2);
      let k = list.findIndex(one => one.t > from);
      for (k = Math.max(0, (k < 0 ? list.length : k) - 1); k < list.length && list[k].t < page.to; k++) {
        const a = x(Math.max(0, list[k].t)), b = x(Math.min(page.to, list[k + 1]?.t ?? page.to)), {state} = list[k].value;
        draw.fillStyle = stateColour(state); draw.fillRect(a, y + 2, Math.max(1, b - a), TALL - 4);
        const name = stateName(state), need = draw.measureText(name).width + 10;
        if (b - a > need) { draw.fillStyle = state === 0 || state === 4 ? css("ink") : "#10151a"; draw.fillText(name, a + 5, y + TALL / 2); }
      }
    });
    draw.fillStyle = css("soft");
    const y = TALL * chosen.length + 10, step = span / 4;
    for (let k = 0; k <= 4; k++) {
      draw.textAlign = k === 4 ? "right" : k === 0 ? "left" : "center";
      if (from + k * step >= 0) draw.fillText(`${+(from + k * step).toFixed(2)}`, LEFT + k * room / 4, y);
    }
    draw.textAlign = "left";
    bands.element.setAttribute("aria-label", chosen.map(key => `channel ${channelName(key)} ${stateName(page.states.at(key, page.to)?.state ?? 0)}`).join(", "));
  },
});
