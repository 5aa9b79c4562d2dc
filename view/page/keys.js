// What keys do; those of a field that is written in do that alone.
export function listenToKeys(page) {
  const press = id => () => document.getElementById(id).click();
  const actions = {
    g: press('tool-grasp'),
    c: press('tool-cautery'),
    x: press('tool-scalpel'),
    p: press('tool-probe'),
    j: press('tool-jaws'),
    e: press('tool-paint'),
    ' ': press('pause'),
    '.': press('single'),
    s: press('slow'),
    b: press('back'),
    r: press('restart'),
    m: press('mesh'),
    f: press('fibres'),
    k: press('skin'),
    i: press('picture'),
    v: press('video'),
    '?': press('help-button'),
    h: () => page.hands.keep(),
    home: () => page.stage.home(),
    escape: () => {
      document.getElementById('overlay').dataset.lasting !== '1' &&
        (document.getElementById('overlay').hidden = true);
      page.hands.releaseHeld();
    },
  };
  addEventListener('keydown', event => {
    const isField = /^(text|number|)$/.test(event.target.type ?? 'none');
    if (event.ctrlKey || event.metaKey || event.altKey || isField) return;
    const act = actions[event.key.toLowerCase()];
    if (!act || (event.repeat && event.key !== '.')) return;
    event.preventDefault();
    act();
  });
}
