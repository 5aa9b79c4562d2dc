// A hand that keys lead: a pointer of its own in the window, which the instruments take like a mouse.
const pointer = -1, // no browser gives a pointer this number
  step = 10; // [pixels]

export class KeyHand {
  constructor(stage, hands) {
    this.stage = stage;
    this.hands = hands;
    this.isOn = false;
    this.mark = Object.assign(document.createElement('div'), {id: 'key-hand', hidden: true});
    document.body.append(this.mark);
  }

  /** Its instrument has begun: until it is let go, by whatever. */
  get isDown() {
    return this.hands.actives.has(pointer) || this.hands.camera.has(pointer);
  }

  event(more = {}) {
    const {x, y} = this,
      common = {pointerId: pointer, button: 0, timeStamp: performance.now(), preventDefault() {}};
    return {...common, offsetX: x, offsetY: y, ...more};
  }

  /** It begins over the middle of the organ, or goes away. */
  toggle(on = !this.isOn) {
    if (on === this.isOn) return;
    this.isOn = on;
    this.mark.hidden = !on;
    if (!on) return this.leave();
    const {x, y} = this.stage.project(this.stage.target);
    [this.x, this.y] = [Math.round(x), Math.round(y)];
    this.place();
  }

  leave() {
    if (this.isDown) this.press();
    this.hands.showNothing();
  }

  place() {
    this.mark.style.transform = `translate(${this.x}px, ${this.y}px)`;
    this.mark.classList.toggle('down', this.isDown);
    this.hands.move(this.event());
  }

  /** By so many steps. */
  shift(dx, dy) {
    const {clientWidth, clientHeight} = this.stage.canvas,
      within = (value, most) => Math.max(0, Math.min(most, value));
    this.x = within(this.x + step * dx, clientWidth);
    this.y = within(this.y + step * dy, clientHeight);
    this.place();
  }

  /** Nearer to the viewer, or farther, as a wheel does. */
  wheel(notches) {
    if (this.isDown) this.hands.wheel(this.event({deltaY: 100 * notches, deltaMode: 0}));
  }

  /** The instrument begins, or ends. */
  press() {
    if (this.isDown) this.hands.up(this.event());
    else this.hands.down(this.event());
    this.mark.classList.toggle('down', this.isDown);
  }
}
