// Pictures and videos of the canvas, saved by the browser.

function save(blob, name) {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

export const stamp = () => new Date().toISOString().slice(0, 19).replace(/[:T]/g, '-');

export function savePicture(canvas) {
  canvas.toBlob(blob => save(blob, `lobe-${stamp()}.png`), 'image/png');
}

export class Video {
  constructor(canvas, onChange) {
    this.canvas = canvas;
    this.onChange = onChange;
  }

  toggle() {
    this.recorder ? this.recorder.stop() : this.start();
  }

  start() {
    if (!window.MediaRecorder) return this.onChange(false, 'This browser cannot record videos.');
    const type = ['video/webm;codecs=vp9', 'video/webm;codecs=vp8', 'video/webm', 'video/mp4'].find(t =>
      MediaRecorder.isTypeSupported(t),
    );
    const pieces = [];
    this.recorder = new MediaRecorder(this.canvas.captureStream(30), {
      mimeType: type,
      videoBitsPerSecond: 12e6,
    });
    this.recorder.ondataavailable = event => pieces.push(event.data);
    this.recorder.onstop = () => {
      this.recorder = null;
      save(new Blob(pieces, {type}), `lobe-${stamp()}.${type.includes('mp4') ? 'mp4' : 'webm'}`);
      this.onChange(false);
    };
    this.recorder.start(500);
    this.onChange(true);
  }
}
