// The site's front page: msn_core's RTL as WebAssembly (core.js), played with a scene's samples or with the mouse.
(() => {
  const S = window.SCENE, root = document.getElementById("try");
  if (!root || !S || !window.MeissnerCore) return;
  const STATES = ["no contact", "contact", "incipient slip", "gross slip"];
  const SPAN = 1.5 * S.rate_hz;  // samples shown
  const STEP = 20;  // samples a column of a plot
  const bytes = (text, Kind) => new Kind(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer);
  const codes = bytes(S.codes, Int16Array), p2p = bytes(S.p2p, Int32Array), state = bytes(S.state, Uint8Array);
  root.innerHTML = `
    <div class="try-bar">
      <button data-do="play">Play the scene</button><button data-do="mouse">Press with the mouse</button>
      <label>threshold <input type="range" min="1" max="${S.threshold.value * 4}" value="${S.threshold.value}">
      <output></output></label>
    </div>
    <canvas height="330" tabindex="0" aria-label="voltage, Haar detail, peak to peak and state"></canvas>
    <p class="try-now" aria-live="polite"></p><p class="try-said"></p>`;
  const canvas = root.querySelector("canvas"), slider = root.querySelector("input"), output = root.querySelector("output");
  const now = root.querySelector(".try-now"), said = root.querySelector(".try-said"), g = canvas.getContext("2d");
  const columns = [];  // of STEP samples: {low, high, detail, p2p, state, raised}
  let core, column, last = { p2p: 0, state: 0 }, mode = "", place = 0, seen = 0, flag = "no slip yet";
  const at = { down: false, press: 0, pull: 0, x: 0, y: 0, stuck: 0, level: 0 };

  const next = (code) => {
    const f = core._next(code, S.bits) >> 2, H = core.HEAP32;
    return { decided: H[f], p2p: H[f + 1], state: H[f + 2], raised: H[f + 3], clocks: H[f + 4], detail: H[f + 6] };
  };
  const restart = () => {
    core._start();
    for (const [address, word] of Object.entries(S.registers)) core._put(Number(address), word);
    threshold();
    columns.length = seen = place = 0;
    column = undefined;
    last = { p2p: 0, state: 0 };
  };
  const threshold = () => {
    core._put(S.threshold.address, Number(slider.value));
    const word = core._get(S.threshold.address);
    output.textContent = `${word} codes, ${((word * Math.abs(S.volts[1])) / 2 ** (S.level / 2)).toFixed(4)} V (read from the register)`;
  };
  const give = (code) => {
    const got = next(code);
    if (!column || column.count === STEP) columns.push((column = { low: code, high: code, detail: 0, count: 0, raised: 0 }));
    column.count += 1;
    column.low = Math.min(column.low, code);
    column.high = Math.max(column.high, code);
    column.detail = Math.max(column.detail, Math.abs(got.detail));
    seen += 1;
    if (got.decided) {
      if (got.raised) {
        column.raised = 1;
        flag = `flag ${got.clocks} clocks after the sample that shows it, at ${(seen / S.rate_hz).toFixed(4)} s`;
      }
      last = got;
    }
    column.p2p = last.p2p;
    column.state = last.state;
    if (columns.length > SPAN / STEP) columns.shift();
  };

  // The mouse's rubber is a sketch: voltage falls with the press, a pull beyond half of the press creeps in steps, one
  // beyond all of it slides. The scenes' rubber is model/meissner/physics.
  const sketch = () => {
    at.level += ((at.down ? at.press : 0) - at.level) / 200;
    const ratio = at.level > 0.03 ? Math.abs(at.pull) / at.level : 0;
    if (ratio > 1) at.stuck = 0.1 * (Math.random() - 0.5);
    else if (ratio > 0.5 && Math.random() < 0.004) at.stuck = 0.03 * (Math.random() - 0.5);
    else at.stuck *= 0.97;
    const volts = 4.9 - 2.2 * at.level + at.stuck + 0.001 * (Math.random() - 0.5);
    return Math.round((volts - S.volts[0]) / S.volts[1]);
  };

  const style = (name) => getComputedStyle(root).getPropertyValue(name).trim();
  const draw = () => {
    const width = (canvas.width = canvas.clientWidth), rows = [0, 110, 220], tall = 92;
    const ink = style("--color-foreground-primary") || "#000", line = style("--color-brand-primary") || "#06c";
    g.clearRect(0, 0, width, canvas.height);
    const x = (k) => (k * STEP * width) / SPAN;
    const bands = ["transparent", "#2ca02c33", "#ff7f0e66", "#d6272899"];
    columns.forEach((c, k) => {
      g.fillStyle = bands[c.state] || bands[3];
      g.fillRect(x(k), rows[0], x(1) + 1, rows[2] + tall);
    });
    const plot = (row, name, low, high, ends) => {
      const y = (v) => row + 16 + (tall - 18) * (1 - (v - low) / (high - low || 1));
      g.fillStyle = ink;
      g.font = "12px sans-serif";
      g.fillText(name, 4, row + 12);
      g.fillStyle = line;
      columns.forEach((c, k) => {
        const [a, b] = ends(c);
        g.fillRect(x(k), y(b), Math.max(1, x(1)), Math.max(1.5, y(a) - y(b)));
      });
      return y;
    };
    const most = (of, least) => columns.reduce((top, c) => Math.max(top, of(c)), least);
    const volts = (code) => S.volts[0] + S.volts[1] * code;
    plot(rows[0], "voltage at the pin, 0 to 5 V", 0, 5, (c) => [volts(c.low), volts(c.high)].sort());
    const limit = Number(slider.value), high = most((c) => c.p2p, 3 * limit);
    plot(rows[1], `Haar detail, to ${most((c) => c.detail, limit)} codes`, 0, most((c) => c.detail, limit), (c) => [0, c.detail]);
    const y = plot(rows[2], `peak to peak and threshold, to ${high} codes`, 0, high, (c) => [0, c.p2p]);
    g.fillStyle = "#d62728";
    g.fillRect(0, y(limit), width, 1.5);
    now.textContent = `${STATES[last.state] || last.state}; ${flag}`;
  };

  const frame = () => {
    if (mode && document.visibilityState === "visible") {
      for (let k = 0; k < S.rate_hz / 60; ++k) {
        if (mode === "play" && place === codes.length) restart();
        give(mode === "play" ? codes[place++] : sketch());
      }
      draw();
    }
    requestAnimationFrame(frame);
  };
  const move = (event) => {
    const box = canvas.getBoundingClientRect();
    at.press = Math.min(1, Math.max(0, (event.clientY - box.top) / box.height));
    at.pull = at.down ? (event.clientX - at.x) / box.width : 0;
  };
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    at.x = event.clientX;
    at.down = true;
    move(event);
    if (mode !== "mouse") choose("mouse");
  });
  canvas.addEventListener("pointermove", move);
  canvas.addEventListener("pointerup", () => (at.down = false));
  canvas.addEventListener("keydown", (event) => {
    if (event.key === " ") {
      event.preventDefault();
      at.down = !at.down;
      at.press = 0.6;
      if (mode !== "mouse") choose("mouse");
    }
    if (event.key === "ArrowRight") at.pull = Math.min(1, at.pull + 0.1);
    if (event.key === "ArrowLeft") at.pull = Math.max(0, at.pull - 0.1);
  });
  const choose = (which) => {
    mode = which;
    flag = "no slip yet";
    restart();
  };
  root.querySelectorAll("button").forEach((button) => button.addEventListener("click", () => choose(button.dataset.do)));
  slider.addEventListener("input", () => core && threshold());

  window.MeissnerCore().then((made) => {
    core = made;
    restart();
    let decisions = 0, wrong = 0;
    for (const code of codes.subarray(0, 2 * S.rate_hz)) {
      const got = next(code);
      if (got.decided) {
        wrong += got.p2p !== p2p[decisions] || got.state !== state[decisions];
        decisions += 1;
      }
    }
    said.textContent = `msn_core of commit ${S.rtl}, Verilated. ${decisions} decisions on the first two seconds of
      ${S.scene}: ${wrong ? `${wrong} differ from` : "all equal"} those of its twin in Python. The mouse's rubber is a
      sketch: press by the pointer's height, pull sideways, or space and the arrow keys.`;
    root.dataset.ready = wrong ? "wrong" : "right";
    choose("play");
    while (place < SPAN) give(codes[place++]);  // begin with a full picture
    requestAnimationFrame(frame);
  });
})();
