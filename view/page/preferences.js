// What a user prefers of the page itself, kept in this browser: a light window, and figures about the
// simulation.

const known = ['light', 'details'];

function stored(name) {
  try {
    return localStorage.getItem(`lobe ${name}`) === 'on';
  } catch {
    return false; // a browser that keeps nothing
  }
}

function store(name, on) {
  try {
    localStorage.setItem(`lobe ${name}`, on ? 'on' : 'off');
  } catch {
    /* it is not kept */
  }
}

/** Each is a box to check, and a class of the body. @param {(name: string, on: boolean) => void} changed */
export function listenToPreferences(changed) {
  for (const name of known) {
    const box = document.getElementById(name);
    const use = on => {
      document.body.classList.toggle(name, on);
      changed(name, on);
    };
    box.checked = stored(name);
    box.onchange = () => {
      store(name, box.checked);
      use(box.checked);
    };
    use(box.checked);
  }
}
