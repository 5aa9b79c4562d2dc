// What keys do. Those of a field, a list or a button that has the focus do what they do there.
const turn = 40, // by a press of an arrow [pixels of a drag]
  nearer = 1.12;

export function listenToKeys(page) {
  const {stage} = page;
  const press = id => () => {
    const button = document.getElementById(id);
    if (!button.hasAttribute('data-foreign')) button.click();
  };
  const arrow = (dx, dy) => event => {
    const steps = event.shiftKey ? 4 : 1;
    if (page.keyHand.isOn) page.keyHand.shift(-Math.sign(dx) * steps, -Math.sign(dy) * steps);
    else if (event.shiftKey) stage.shift(dx, dy);
    else stage.turn(dx, dy);
  };
  const actions = {
    g: press('tool-grasp'),
    c: press('tool-cautery'),
    x: press('tool-scalpel'),
    p: press('tool-probe'),
    j: press('tool-jaws'),
    u: press('tool-hook'),
    a: press('tool-clip'),
    n: press('tool-stitch'),
    d: () => page.hands.setPedal(true),
    e: press('tool-paint'),
    t: press('tool-measure'),
    l: press('open-button'),
    ' ': press('pause'),
    '.': press('single'),
    s: press('slow'),
    b: press('back'),
    r: press('restart'),
    m: press('mesh'),
    f: press('fibres'),
    o: press('section'),
    k: press('skin'),
    i: press('picture'),
    v: press('video'),
    '?': press('help-button'),
    h: () => page.hands.keep(),
    home: () => page.home(),
    arrowleft: arrow(turn, 0),
    arrowright: arrow(-turn, 0),
    arrowup: arrow(0, turn),
    arrowdown: arrow(0, -turn),
    '[': () => page.sizes.change(-1),
    ']': () => page.sizes.change(1),
    '+': () => stage.zoom(1 / nearer),
    '-': () => stage.zoom(nearer),
    y: () => page.keyHand.toggle(),
    enter: () => page.keyHand.isOn && page.keyHand.press(),
    pageup: () => page.keyHand.wheel(-1),
    pagedown: () => page.keyHand.wheel(1),
    escape: () => {
      page.keyHand.toggle(false);
      document.getElementById('overlay').dataset.lasting !== '1' &&
        (document.getElementById('overlay').hidden = true);
      page.hands.releaseHeld();
      page.tape.clear();
    },
  };
  // A button that the mouse has pressed does not keep the space bar.
  addEventListener('click', event => {
    const isPressed = event.target.closest?.('#dock button, #banner button, .check');
    if (event.detail > 0 && isPressed) stage.canvas.focus();
  });
  const undo = event => {
    event.preventDefault();
    press(page.mode === 'edit' ? 'undo' : 'undo-act')();
  };
  addEventListener('keyup', ({key}) => key.toLowerCase() === 'd' && page.hands.setPedal(false));
  addEventListener('blur', () => page.hands.setPedal(false));
  const mayRepeat = /^(\.|\+|-|\[|\]|arrow.*|page.*)$/;
  addEventListener('keydown', event => {
    const key = event.key.toLowerCase(),
      {target} = event;
    if (target.matches?.('select, textarea, input:not([type=checkbox], [type=range])')) return;
    const asksToUndo = (event.ctrlKey || event.metaKey) && !event.shiftKey && key === 'z';
    if (asksToUndo) return undo(event);
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (target.matches?.('input[type=range]') && /^(arrow|page|home|end)/.test(key)) return;
    // What these press.
    if ((key === ' ' || key === 'enter') && target.matches?.('button, summary, input')) return;
    const act = actions[key];
    if (!act || (event.repeat && !mayRepeat.test(key))) return;
    event.preventDefault();
    act(event);
  });
}
