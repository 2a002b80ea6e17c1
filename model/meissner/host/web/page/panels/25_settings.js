// Settings in the core: a slider or a number writes a register, what it reads back is shown.
import {make, page, panel, post, withUnit} from "/page.js";

const SLIDERS = ["slip.threshold", "slip.keep_threshold", "slip.gross_threshold", "slip.contact_level", "slip.release_level", "cop.min_load", "cop4.min_load", "cop_slip.drop", "grip.step"];
const STEPS = 1000;
let body, rows = new Map();

// A slider's steps grow with the value, in both directions from 0: fine where thresholds are, and up to the ends.
const bend = value => Math.sign(value) * Math.log1p(Math.abs(value)), unbend = place => Math.sign(place) * Math.expm1(Math.abs(place));
const toPlace = ([least, most], value) => STEPS * (bend(value) - bend(least)) / (bend(most) - bend(least));
const toValue = ([least, most], place) => Math.round(Math.max(least, Math.min(most, unbend(bend(least) + place / STEPS * (bend(most) - bend(least))))));

function row(setting) {
  const {name, least, most, reach, scale} = setting, id = `set-${name}`;
  const field = make("input", {id, type: "number", min: least, max: most, step: 1});
  const found = make("div", {className: "setting"}, make("label", {htmlFor: id, textContent: name}), field);
  const said = make("output", {htmlFor: id});
  let slider = null, waiting = null, busy = false, held = false;
  async function write(value) {
    waiting = value;
    if (busy) return;
    busy = true;
    while (waiting !== null) {
      const now = waiting;
      waiting = null;
      try {
        const answer = await (await post("/set", {name, value: now})).json();
        show(answer.value);
      } catch (problem) {
        said.className = "bad"; said.textContent = problem.message;
        show(page.registers.now(name), true);
      }
    }
    busy = false;
  }
  function show(value, keep = false) {
    if (value === undefined) return;
    if (document.activeElement !== field) field.value = value;
    if (slider && !held) slider.value = toPlace(reach, value);
    if (slider) slider.setAttribute("aria-valuetext", `${value}`);
    if (keep) return;
    said.className = "";
    said.textContent = value > reach[1] ? `has ${value}: out of reach` : `has ${value}${scale ? `, ${withUnit(value, scale)}` : ""}`;
    said.title = "as the core reads it back";
    rows.get(name).shown = value;
  }
  field.onchange = () => { if (field.value !== "") write(Math.round(+field.value)); };
  if (SLIDERS.includes(name) && most - least > 1) {
    slider = make("input", {type: "range", min: 0, max: STEPS, step: 1, ariaLabel: name});
    slider.oninput = () => { field.value = toValue(reach, +slider.value); write(+field.value); };
    slider.onpointerdown = () => { held = true; };
    slider.onpointerup = slider.onpointercancel = () => { held = false; };
    found.append(slider);
  }
  found.append(said);
  rows.set(name, {show, busy: () => busy, shown: undefined});
  return found;
}

panel({
  id: "settings", title: "Settings", shape: "tall",
  shown: () => (page.hello?.settings.length ?? 0) > 0,
  build(found) { body = found; },
  begin(hello) {
    rows = new Map();
    const off = name => hello.now.register[`${name.split(".")[0]}.enable`] === 0, first = ({name}) => SLIDERS.includes(name) && !off(name);
    const main = hello.settings.filter(first).sort((a, b) => SLIDERS.indexOf(a.name) - SLIDERS.indexOf(b.name)), rest = hello.settings.filter(setting => !first(setting));
    body.parentElement.classList.toggle("tall", main.length > 2);
    body.replaceChildren(...(main.length ? main : rest).map(row));
    if (main.length && rest.length) body.append(make("details", {}, make("summary", {textContent: `${rest.length} more`}), ...rest.map(row)));
  },
  draw() {
    for (const [name, one] of rows) {
      const value = page.registers.now(name);
      if (value !== one.shown && !one.busy()) one.show(value);
    }
  },
});
