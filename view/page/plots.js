// Force of the hands and energy of the body over the last seconds.
import uPlot from './third_party/uplot-1.6.32/uPlot.esm.js';

const seconds = 10;

export class Plot {
  /** @param {{label: string, colour: string}[]} series */
  constructor(element, series, digits) {
    this.data = [[], ...series.map(() => [])];
    this.element = element;
    const ofPage = name => () => getComputedStyle(document.body).getPropertyValue(name);
    const axis = {
      stroke: ofPage('--soft'),
      font: '11px system-ui',
      grid: {stroke: ofPage('--line'), width: 1},
      ticks: {show: false},
    };
    this.plot = new uPlot(
      {
        width: 208,
        height: 84,
        cursor: {show: false},
        legend: {show: false},
        padding: [6, 10, 0, 0],
        scales: {
          x: {time: false},
          y: {range: (_, low, high) => [Math.min(0, low), Math.max(high * 1.1, 10 ** -digits * 4)]},
        },
        axes: [
          {...axis, size: 20, values: (_, ticks) => ticks.map(t => `${t}`)},
          {...axis, size: 38},
        ],
        series: [
          {},
          ...series.map(s => ({label: s.label, stroke: s.colour, width: 1.6, points: {show: false}})),
        ],
      },
      this.data,
      element,
    );
    this.drawn = 0;
    this.pause = 150; // between two pictures [ms]
  }

  add(time, values) {
    const times = this.data[0],
      last = times[times.length - 1];
    if (last !== undefined && time < last) this.clear(); // restarted, or gone back
    if (time === last) return;
    times.push(time);
    values.forEach((value, i) => this.data[i + 1].push(value));
    let old = 0;
    while (times[old] < time - seconds) ++old;
    if (old > 60) for (const column of this.data) column.splice(0, old);
    const now = performance.now();
    if (now - this.drawn < this.pause || !this.element.offsetParent) return;
    this.drawn = now;
    this.plot.setData(this.data, false);
    this.plot.setScale('x', {min: Math.max(0, time - seconds), max: Math.max(seconds, time)});
  }

  /** The page has other colours. */
  dress() {
    this.plot.redraw(false);
  }

  clear() {
    for (const column of this.data) column.length = 0;
  }
}
