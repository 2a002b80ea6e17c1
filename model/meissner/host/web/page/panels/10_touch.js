// The tactile image, the centre of pressure with its trail, slipping and faulty taxels.
import {canvas, css, faults, fixed, make, number, page, panel, stateColour, stateName} from "/page.js";

const TRAIL_S = 2;
let surface, words, sub, place = null;

const imageAt = t => {
  const {images} = page;
  let low = 0, high = images.length;
  while (low < high) { const mid = (low + high) >> 1; if (images[mid].t <= t) low = mid + 1; else high = mid; }
  return images[low - 1] ?? images[0];
};
const rgb = text => [1, 3, 5].map(k => parseInt((text.length === 4 ? text.replace(/./g, c => c === "#" ? c : c + c) : text).slice(k, k + 2), 16));
const small = document.createElement("canvas");

function heat(image) {
  const [rows, columns] = image.shapes.taxels, [cold, hot] = [rgb(css("cold")), rgb(css("hot"))];
  small.width = columns; small.height = rows;
  const picture = small.getContext("2d").createImageData(columns, rows);
  let most = 1;
  for (const value of image.taxels) if (value > most) most = value;
  image.taxels.forEach((value, k) => {
    const share = Math.sqrt(value / most);
    for (let c = 0; c < 3; c++) picture.data[4 * k + c] = cold[c] + share * (hot[c] - cold[c]);
    picture.data[4 * k + 3] = 255;
  });
  small.getContext("2d").putImageData(picture, 0, 0);
  return most;
}

panel({
  id: "touch", title: "Touch", picture: true,
  shown: () => page.images.length > 0 || page.cop.length > 0,
  build(body, title) {
    sub = title.appendChild(make("small"));
    surface = canvas(body, 300);
    words = body.appendChild(make("p", {className: "note"}));
    surface.element.onclick = click => {
      if (!place || !place.columns) return;
      const column = Math.floor((click.offsetX - place.x) / place.cell), row = Math.floor((click.offsetY - place.y) / place.cell);
      if (column >= 0 && row >= 0 && column < place.columns && row < place.rows) [page.channel, page.chosen] = [row * place.columns + column, true];
    };
  },
  draw() {
    const image = imageAt(page.to);
    const [rows, columns] = image?.shapes.taxels ?? (page.hello.core.rows > 1 ? [page.hello.core.rows, page.hello.core.columns] : [1, 1]);
    const width = surface.element.parentElement.clientWidth, aspect = image ? rows / columns : 1;
    const [draw, wide, tall] = surface.begin(Math.min(360, Math.max(120, width * aspect)));
    const cell = Math.min(wide / columns, tall / rows), w = cell * columns, h = cell * rows, x = (wide - w) / 2, y = (tall - h) / 2;
    place = image ? {x, y, cell, rows, columns} : null;
    let text = "";
    if (image) {
      const most = heat(image), unit = image.newtons_per_code;
      draw.imageSmoothingEnabled = false;
      draw.drawImage(small, x, y, w, h);
      text = `image ${image.number}, ${rows}×${columns}, largest ${unit ? `${number(most * unit, 3)} N` : most}`;
      const alone = page.traces.size > 0;  // then the channels are not this array's taxels
      for (const key of alone ? [] : page.states.of.keys()) {
        const state = page.states.at(key, page.to)?.state;
        if (state !== 2 && state !== 3) continue;
        draw.strokeStyle = stateColour(state); draw.lineWidth = 2;
        draw.strokeRect(x + cell * (key % columns) + 1, y + cell * Math.floor(key / columns) + 1, cell - 2, cell - 2);
      }
      draw.strokeStyle = css("gross"); draw.lineWidth = 1.5;
      for (const [taxel, bits] of page.health) {
        if (!bits || taxel >= rows * columns) continue;
        const a = x + cell * (taxel % columns), b = y + cell * Math.floor(taxel / columns), k = Math.max(1, cell * 0.2);
        draw.beginPath(); draw.moveTo(a + k, b + k); draw.lineTo(a + cell - k, b + cell - k);
        draw.moveTo(a + cell - k, b + k); draw.lineTo(a + k, b + cell - k); draw.stroke();
      }
      if (!alone && page.channel < rows * columns) {
        draw.strokeStyle = css("accent"); draw.lineWidth = 1;
        draw.strokeRect(x + cell * (page.channel % columns) + 0.5, y + cell * Math.floor(page.channel / columns) + 0.5, cell - 1, cell - 1);
      }
    } else {
      draw.strokeStyle = css("line"); draw.strokeRect(x + 0.5, y + 0.5, w - 1, h - 1);
    }
    // x and y are -1 at the centre of the first column and the lowest row, 1 at that of the last.
    const {core} = page.hello, half = (count, pitch) => pitch ? pitch * (count - 1) / 2 : 1;
    const [hx, hy] = [half(core.columns, core.pitch_mm), half(core.rows, core.pitch_mm)];
    const at = (px, py) => [x + w / 2 + (hx ? px / hx : 0) * (w - (image ? cell : 0)) / 2, y + h / 2 - (hy ? py / hy : 0) * (h - (image ? cell : 0)) / 2];
    const [t, cx, cy, load, pressed] = page.cop.columns, end = page.cop.at(page.to + 1e-9);
    const first = page.cop.at(page.to - TRAIL_S), step = Math.max(1, Math.ceil((end - first) / 300));
    draw.lineWidth = 2; draw.strokeStyle = css("incipient");
    for (let k = first + step; k < end; k += step) {
      if (!pressed[k] || !pressed[k - step]) continue;
      draw.globalAlpha = Math.max(0.05, 1 - (page.to - t[k]) / TRAIL_S);
      draw.beginPath(); draw.moveTo(...at(cx[k - step], cy[k - step])); draw.lineTo(...at(cx[k], cy[k])); draw.stroke();
    }
    draw.globalAlpha = 1;
    let where = "";
    if (end > 0) {
      const unit = core.newtons_per_code ? `${number(load[end - 1], 3)} N` : `${load[end - 1]}`;
      where = `load ${unit}`;
      if (pressed[end - 1]) {
        const [px, py] = at(cx[end - 1], cy[end - 1]);
        draw.beginPath(); draw.arc(px, py, 6, 0, 7); draw.fillStyle = css("incipient"); draw.fill();
        draw.lineWidth = 2; draw.strokeStyle = css("card"); draw.stroke();
        where = core.pitch_mm ? `${fixed(cx[end - 1], 2)}, ${fixed(cy[end - 1], 2)} mm, ${where}` : `x ${fixed(cx[end - 1], 3)}, y ${fixed(cy[end - 1], 3)}, ${where}`;
      } else where = `not pressed, ${where}`;
    }
    sub.textContent = where;
    const bad = [...page.health].filter(([, bits]) => bits);
    if (bad.length) text += `${text ? "; " : ""}faulty: ${bad.slice(0, 6).map(([taxel, bits]) => `${taxel} ${faults(bits)}`).join(", ")}${bad.length > 6 ? ` and ${bad.length - 6} more` : ""}`;
    words.textContent = text;
  },
});
