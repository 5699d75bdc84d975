// Names along the curves of a plot. They come with the library, so that a first view is without them.

(() => {
  const SHARES = [0.5, 0.35, 0.65, 0.2, 0.8, 0.1, 0.9];
  const LETTER = 12.5;
  const SPACE = 10; // pixels between a curve and the middle of its name

  // The part of a line between two corners that is in sight, in pixels of the frame, or nothing.
  function inSight([from, to], { width, height }) {
    const step = [to[0] - from[0], to[1] - from[1]];
    let [start, end] = [0, 1];
    for (const [axis, size] of [[0, width], [1, height]]) {
      const [a, b] = [-from[axis] / step[axis], (size - from[axis]) / step[axis]];
      if (step[axis]) [start, end] = [Math.max(start, Math.min(a, b)), Math.min(end, Math.max(a, b))];
      else if (from[axis] < 0 || from[axis] > size) return null;
    }
    return start < end ? [start, end].map((share) => [from[0] + share * step[0], from[1] + share * step[1]]) : null;
  }

  const lengthOf = ([from, to]) => Math.hypot(to[0] - from[0], to[1] - from[1]);

  // Names along the curves that are in sight, none over another or over a point, and the name of the cycle's load at the
  // edge that it lies beyond.
  window.namesAlong = (data, { xaxis, yaxis }, frame) => {
    const [[left, right], [low, high]] = [xaxis.range, yaxis.range];
    const pixels = ([x, y]) => [((x - left) / (right - left)) * frame.width, ((high - y) / (high - low)) * frame.height];
    const values = ([x, y]) => ({ x: left + (x / frame.width) * (right - left), y: high - (y / frame.height) * (high - low) });
    const cornersOf = ({ x, y }) => x.map((radial, k) => pixels([radial, y[k]]));
    const occupied = data.filter(({ text }) => text).flatMap((points) => cornersOf(points).map((at) => ({ at, half: 14, turn: 0 })));
    const annotations = [];
    for (const curve of data.filter(({ meta }) => meta?.label)) {
      const corners = cornersOf(curve);
      const parts = corners.slice(1).flatMap((corner, k) => inSight([corners[k], corner], frame) ?? []);
      const pieces = parts.flatMap((_, k) => (k % 2 ? [] : [[parts[k], parts[k + 1]]]));
      const [longest] = pieces.sort((one, other) => lengthOf(other) - lengthOf(one));
      const half = (curve.meta.label.replace(/<[^>]*>/g, "").length * LETTER) / 4 + 4;
      if (!longest || lengthOf(longest) < 2 * half) continue;
      const [from, to] = longest[0][0] <= longest[1][0] ? longest : longest.toReversed();
      const turn = Math.atan2(to[1] - from[1], to[0] - from[0]);
      const off = [SPACE * Math.sin(turn), -SPACE * Math.cos(turn)];
      const room = half / lengthOf(longest);
      const places = SHARES.filter((share) => share >= room && share <= 1 - room).map((share) => [from[0] + share * (to[0] - from[0]) + off[0], from[1] + share * (to[1] - from[1]) + off[1]]);
      const at = places.find((place) => occupied.every((other) => isApart(place, half, turn, other)));
      if (!at) continue;
      occupied.push({ at, half, turn });
      annotations.push({ ...values(at), text: curve.meta.label, textangle: (turn * 180) / Math.PI, showarrow: false, font: { size: LETTER, color: curve.line.color, shadow: curve.meta.halo } });
    }
    for (const { x, y, text, textfont, meta } of data) {
      if (meta?.kind !== "equivalent") continue;
      const [across, down] = pixels([x[0], y[0]]);
      const beyond = [across < 0 ? "←" : across > frame.width ? "→" : "", down < 0 ? "↑" : down > frame.height ? "↓" : ""].join("");
      if (!beyond) continue;
      const edge = [Math.min(Math.max(across, 0), frame.width), Math.min(Math.max(down, 0), frame.height)];
      annotations.push({ ...values(edge), text: `${text[0]} ${beyond}`, showarrow: false, font: textfont, xanchor: across > frame.width / 2 ? "right" : "left", yanchor: down > frame.height / 2 ? "bottom" : "top" });
    }
    return annotations;
  };

  // True for two names that stand apart along or across the first.
  function isApart(place, half, turn, other) {
    const [x, y] = [other.at[0] - place[0], other.at[1] - place[1]];
    const [along, across] = [x * Math.cos(turn) + y * Math.sin(turn), y * Math.cos(turn) - x * Math.sin(turn)];
    return Math.abs(across) > 16 || Math.abs(along) > half + other.half;
  }
})();
