// The torque as sound: a loop that shakes is heard before it is seen.

/** The sound of a torque: no tone below this in Hz, and no louder than this part of full scale. */
const SOUND = { lowest: 25, loudest: 0.5, ahead: 0.08, farthest: 0.25 };

class Sound {
  #context;
  #input;
  #volume;
  #until = 0;
  /** The rest of a tick at the end of the last piece, as a part of it. */
  #left = 0;

  get isOn() {
    return this.#context?.state === "running";
  }

  /** Turns it on; browsers let a page do so only when a person presses something. */
  async turnOn() {
    this.#context ??= this.#connect();
    await this.#context.resume();
    this.#until = 0;
  }

  turnOff() {
    return this.#context?.suspend();
  }

  /** Between 0 and 1. */
  set volume(part) {
    if (this.#volume) this.#volume.gain.value = SOUND.loudest * part;
  }

  /** A high-pass, so that only what vibrates is heard, and a volume that nothing exceeds. */
  #connect() {
    const context = new AudioContext();
    const highPass = [1, 2].map(
      () => new BiquadFilterNode(context, { type: "highpass", frequency: SOUND.lowest }));
    const limit = new WaveShaperNode(context, { curve: new Float32Array([-1, 0, 1]) });
    this.#volume = new GainNode(context, { gain: SOUND.loudest / 2 });
    [...highPass, limit, this.#volume, context.destination].reduce((from, to) => from.connect(to));
    this.#input = highPass[0];
    return context;
  }

  /** Plays torques, as parts of the most that there is, at a rate in Hz: each is held until the next one, as
   * the motor does. */
  play(torques, rate) {
    if (!this.isOn || torques.length === 0) return;
    const context = this.#context;
    const now = context.currentTime;
    // A page that was too slow begins anew; a page that is too fast leaves out a piece.
    if (this.#until < now) this.#until = now + SOUND.ahead;
    if (this.#until > now + SOUND.farthest) return;
    const perSample = rate / context.sampleRate;
    const samples = Math.floor((torques.length - this.#left) / perSample);
    if (samples < 1) return;
    const buffer = context.createBuffer(1, samples, context.sampleRate);
    const wave = buffer.getChannelData(0);
    for (let sample = 0; sample < samples; sample += 1) {
      const at = this.#left + sample * perSample;
      wave[sample] = torques[Math.min(Math.floor(at), torques.length - 1)];
    }
    this.#left = Math.max(0, this.#left + samples * perSample - torques.length);
    const source = new AudioBufferSourceNode(context, { buffer });
    source.connect(this.#input);
    source.start(this.#until);
    this.#until += samples / context.sampleRate;
  }
}
