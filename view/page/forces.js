// The force on each instrument. The label beside it, the panel and the plot say the same sample; its arrow,
// its figure and its line have the same colour.

export const colours = ['#ffc46b', '#9fd65c', '#e08bd0', '#7fa8ff'];
const warns = 0.6, // share of what a grasp bears at which it begins to turn red
  least = 0.005; // that is a figure [N]

export class Forces {
  constructor() {
    this.places = []; // by place: the number of its tool, or undefined
    this.values = []; // by place [N]; null: there is no instrument
  }

  /** @param {{tool: number, force: number[]}[]} tools each gets a `colour` */
  take(tools) {
    const present = new Set(tools.map(({tool}) => tool));
    this.places = this.places.map(tool => (present.has(tool) ? tool : undefined));
    this.values = colours.map(() => null);
    for (const tool of tools) {
      let place = this.places.indexOf(tool.tool);
      if (place < 0) place = this.places.indexOf(undefined);
      if (place < 0) place = this.places.length;
      this.places[place] = tool.tool;
      tool.colour = colours[place % colours.length];
      if (place < colours.length) this.values[place] = Math.hypot(...tool.force);
    }
  }

  /** Those that are worth a figure. */
  figures() {
    return this.values
      .map((newtons, place) => ({newtons, colour: colours[place]}))
      .filter(({newtons}) => newtons !== null && newtons >= least);
  }
}

/** How near a grasp is to slipping off: 0 where it is far from that, 1 where it slips. */
export const nearness = (newtons, most) =>
  most > 0 ? Math.max(0, Math.min(1, (newtons / most - warns) / (1 - warns))) : 0;
