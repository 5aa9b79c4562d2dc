// How well the page draws: a ladder of steps, and when to go down or up it. No drawing here, so that a test
// can climb it without a browser.

/** What is drawn at a step.
 *  @typedef {object} Step
 *  @property {'fine'|'quick'} look  of looks.js
 *  @property {number} shadow  pixels across the shadow map; 0: the shadow is the organ laid flat
 *  @property {boolean} hasShadow
 *  @property {number} every  of so many pictures one has its shadows drawn anew
 *  @property {number} pixels  that are drawn per pixel of the window, along a line
 *  @property {number} levels  how often the triangles of the surface may be divided
 *  @property {string} words  of how it is drawn, for the user; empty: nothing is saved */

/** The steps, from the best to the cheapest.
 *  @param {number} most pixels per pixel of the window that the screen has
 *  @returns {Step[]} */
export function ladder(most) {
  const fine = (shadow, every, pixels, words) =>
    ({look: 'fine', shadow, hasShadow: true, every, pixels, levels: 2, words});
  const quick = (hasShadow, pixels, levels, words) =>
    ({look: 'quick', shadow: 0, hasShadow, every: 1, pixels, levels, words});
  const usual = Math.min(1, most);
  return [
    fine(2048, 1, most, ''),
    fine(1024, 2, Math.max(usual, 0.75 * most), 'coarser shadows'),
    fine(512, 3, usual, 'coarse shadows'),
    quick(true, usual, 1, 'simple light'),
    quick(true, 0.8 * usual, 0, 'simple light and fewer pixels'),
    quick(true, 0.6 * usual, 0, 'simple light and few pixels'),
    quick(false, 0.5 * usual, 0, 'few pixels and no shadow'),
  ];
}

export const firstQuick = steps => steps.findIndex(step => step.look === 'quick');

const settling = 2, // pictures after a change that are not measured: what is new is compiled and allocated
  hasty = 5, // pictures after which it goes down if they take twice as long as they may
  patient = 20, // … longer than they may
  sure = 40, // … after which it goes up
  soonest = 2e3, // between a change and going up [ms]
  longest = 120e3, // that it waits before it tries again what failed [ms]
  isFailure = 6e3; // going down so soon after going up [ms]

export class Quality {
  /** @param {Step[]} steps
   *  @param {number} start where it begins
   *  @param {{slow?: number, quick?: number}} limits of the median time of a picture [ms]: down above, up
   *  below */
  constructor(steps, start, {slow = 20, quick = 9} = {}) {
    this.steps = steps;
    this.at = start;
    this.limits = {slow, quick};
    this.times = [];
    this.changed = this.wentUp = -Infinity;
    this.pause = soonest; // between a change and going up [ms]
    this.skip = settling;
  }

  get step() {
    return this.steps[this.at];
  }

  /** A picture is finished.
   *  @param {number} took [ms]
   *  @param {number} now [ms]
   *  @returns {boolean} whether the step is another one now */
  drew(took, now) {
    if (this.skip > 0) {
      --this.skip;
      return false;
    }
    this.times.push(took);
    if (this.times.length > sure) this.times.shift();
    const {slow, quick} = this.limits;
    if (this.at + 1 < this.steps.length) {
      if (this.takes(hasty) > 4 * slow) return this.goDown(2, now);
      if (this.takes(hasty) > 2 * slow || this.takes(patient) > slow) return this.goDown(1, now);
    }
    if (this.at > 0 && now - this.changed > this.pause && this.takes(sure) < quick) return this.goUp(now);
    return false;
  }

  /** The median of the last pictures [ms]; NaN if there are fewer since the last change. */
  takes(count) {
    if (this.times.length < count) return NaN;
    return median(this.times.slice(-count));
  }

  // By two steps where it is far too slow. What fails is tried again, but less and less often.
  goDown(steps, now) {
    if (now - this.wentUp < isFailure) this.pause = Math.min(longest, 2 * this.pause);
    return this.goTo(Math.min(this.at + steps, this.steps.length - 1), now);
  }

  goUp(now) {
    this.wentUp = now;
    return this.goTo(this.at - 1, now);
  }

  goTo(at, now) {
    this.at = at;
    this.changed = now;
    this.times = [];
    this.skip = settling;
    return true;
  }
}

function median(values) {
  const sorted = values.toSorted((a, b) => a - b),
    middle = sorted.length >> 1;
  return sorted.length % 2 ? sorted[middle] : (sorted[middle - 1] + sorted[middle]) / 2;
}
