// What there is to say of a haptic device, in a line.

/** @param {HTMLElement} line @param {object | undefined} haptic of the status (protocol.h) */
export function showHaptic(line, haptic) {
  line.hidden = !haptic;
  if (!haptic) return;
  const force = haptic.force ? Math.hypot(...haptic.force).toFixed(2) : '–';
  const parts = [`${haptic.device}: ${haptic.there ? `${force} N` : 'not there'}`];
  parts.push(haptic.direct ? 'direct' : 'extrapolated');
  if (haptic.interventions > 0) parts.push(`damped ${haptic.interventions} ×`);
  line.textContent = parts.join(' · ');
  line.classList.toggle('slow', haptic.there === false || haptic.real_time === false);
  line.title = [
    ...(haptic.warnings ?? []),
    `1 kHz loop: 99 % of the ticks at most ${(1e3 * (haptic.late ?? 0)).toFixed(2)} ms late, ` +
      `${haptic.missed ?? 0} of ${haptic.ticks ?? 0} missed; old model in ${haptic.stale ?? 0}`,
    `passivity: ${((haptic.energy ?? 0) * 1e3).toFixed(1)} mJ, damping added in ${haptic.interventions ?? 0} ticks`,
  ].join('\n');
}
