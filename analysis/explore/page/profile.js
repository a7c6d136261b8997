// The torque over the angle, at rest: a torque profile with its steepest slopes, or the line of a wall.

/** How much of the picture the line of the slope that certifies takes at most. */
const PROFILE_REACH = 0.2;

/** Draws the scene's torque over the angle whenever the scene changes. */
class ProfilePicture {
  #engine;
  #picture;

  constructor(engine, parent) {
    this.#engine = engine;
    this.#picture = new Picture(parent, { name: "profile", title: "Torque over angle", height: 260 });
  }

  /** Shows a scene, given as text. */
  show(text) {
    this.#picture.update(() => this.#compute(text));
  }

  #compute(text) {
    let profile;
    try {
      profile = this.#engine.json("profile", text);
    } catch (refusal) {
      const sentence = refusalOf("torque over angle", refusal.message);
      this.#picture.draw({ sentence, words: () => sentence });
      return;
    }
    const [angles, torques] = columnsOf(this.#engine.numbers(), 2);
    const legend = profileLegend(profile);
    const own = function* () {
      yield* torques;
      for (const branch of profile.branches ?? []) for (const point of branch.points) yield point[1];
    };
    const felt = atHandle(profile, angles, torques);
    const x = { name: "angle", unit: "rad", range: rangeAround([...angles, ...felt], 0.02) };
    const y = { name: "torque", unit: "N m", range: rangeAround(own(), 0.12, 1e-6) };
    this.#picture.draw({
      x,
      panels: [{ y, paint: (pen) => paintProfile(pen, profile, angles, torques, x.range, y.range) }],
      legend,
      words: () => legend.map((entry) => entry.words).join(". "),
    });
  }
}

/** The angles of the handle, behind the coupling. */
function atHandle(profile, angles, torques) {
  return angles.map((angle, index) => angle + profile.compliance * torques[index]);
}

/** The line of the torque that is felt. */
const FELT = { ink: "--plot-4", dash: [6, 3], width: 2 };

function profileLegend(profile) {
  const limit = profile.limit === null
    ? []
    : [{ dash: [2, 4], width: 1, words: `torque limit, ${plotNumber(profile.limit)} N m` }];
  const felt = profile.felt === null
    ? []
    : [{ ...FELT, words: `at the handle, behind the coupling: up to ${plotNumber(profile.felt)} N m/rad` }];
  if (profile.kind === "wall") return [{ ink: "--plot-1", words: profile.words }, ...felt, ...limit];
  const slope = (value) => `${plotNumber(value)} N m/rad`;
  return [
    {
      ink: "--plot-2",
      width: 4,
      words: `steepest rise, ${slope(profile.rise.slope)}, and steepest fall, ${slope(profile.fall.slope)}`,
    },
    {
      ink: "--plot-3",
      dash: [9, 5],
      words: profile.certified === null
        ? "no rise certifies"
        : `steepest rise that certifies, ${slope(profile.certified)}`,
    },
    ...(profile.branches.length === 0
      ? []
      : [{ ink: "--plot-1", dash: [2, 4], words: "a detent snaps to the next one, from the dot on" }]),
    ...felt,
    ...limit,
  ];
}

function paintProfile(pen, profile, angles, torques, x, y) {
  pen.level(0, { ink: "--plot-faint", width: 1 });
  if (profile.limit !== null) {
    for (const level of [-profile.limit, profile.limit]) pen.level(level, { dash: [2, 4], width: 1 });
  }
  const branches = profile.branches ?? [];
  const lines = branches.length === 0
    ? [[angles, torques]]
    : branches.map(({ points }) => [0, 1].map((column) => points.map((point) => point[column])));
  if (profile.felt !== null) {
    for (const [angle, torque] of lines) pen.line(atHandle(profile, angle, torque), torque, FELT);
  }
  if (branches.length === 0) pen.line(angles, torques, { ink: "--plot-1", width: 2 });
  for (const { points, snaps } of branches) {
    pen.line(points.map((point) => point[0]), points.map((point) => point[1]), { ink: "--plot-1", width: 2 });
    for (const [angle, before, after] of snaps) {
      pen.line([angle, angle], [before, after], { ink: "--plot-1", dash: [2, 4] });
      pen.dot(angle, before, { ink: "--plot-1" });
    }
  }
  if (profile.kind !== "profile") return;
  const along = ({ angle, torque, slope }, half, stroke) => {
    pen.line([angle - half, angle + half], [torque - half * slope, torque + half * slope], stroke);
  };
  for (const piece of [profile.rise, profile.fall]) {
    along(piece, piece.width / 2, { ink: "--plot-2", width: 4 });
  }
  if (profile.certified !== null) {
    const { angle, torque } = profile.rise;
    const room = Math.max(0, Math.min(y[1] - torque, torque - y[0]));
    const wide = Math.min(PROFILE_REACH * (x[1] - x[0]), x[1] - angle, angle - x[0]);
    const half = Math.min(wide, room / profile.certified);
    along({ ...profile.rise, slope: profile.certified }, half, { ink: "--plot-3", dash: [9, 5], width: 2 });
  }
}
