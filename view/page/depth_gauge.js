// The blade of a scalpel beside the pointer, seen from the side: how deep it is, and how thick the organ is
// there. From where the viewer looks the blade itself is a point.
import {inMillimetres} from './tool_sizes.js';

const height = 72,
  above = 16, // of the surface [pixels]
  picture = `<svg viewBox="0 0 34 ${height + above + 4}" width="34" height="${height + above + 4}">
    <rect class="organ" x="4" width="26" y="${above}"/><path class="blade"/></svg><span></span>`;

export class DepthGauge {
  constructor(element) {
    this.element = element;
    element.innerHTML = picture;
    this.organ = element.querySelector('.organ');
    this.blade = element.querySelector('.blade');
    this.text = element.querySelector('span');
  }

  /** @param {number} x of the pointer [pixels] @param {number} depth [m] @param {number} thickness [m] */
  show(x, y, depth, thickness) {
    const scale = height / Math.max(depth, thickness, 1e-6),
      tip = above + scale * depth,
      belly = Math.max(above / 2, tip - 12),
      goesThrough = depth >= thickness,
      top = Math.max(56, Math.round(y) - 112);
    this.element.hidden = false;
    this.element.classList.toggle('through', goesThrough);
    this.element.style.transform = `translate(${Math.round(x) - 164}px, ${top}px)`;
    this.organ.setAttribute('height', String(Math.max(2, scale * thickness)));
    this.blade.setAttribute('d', `M13 0H21V${belly}L17 ${tip}L13 ${Math.max(0, tip - 18)}Z`);
    this.text.textContent = `${inMillimetres(depth)}\n${
      goesThrough ? 'cuts through' : `of ${inMillimetres(thickness)}`
    }`;
  }

  hide() {
    this.element.hidden = true;
  }
}
