// What the page is given (crates/report/src/data.rs), and the periods in it.

export type Maybe<T> = T | null;

export interface Page {
  version: string;
  results: Result[];
}

export interface Result {
  label: string;
  scene: string;
  kind: "sweep" | "curve" | "mode";
  parameter: { name: string; unit: string };
  dofs: string[];
  harmonic: number;
  facts: { what: string; value: string }[];
  notes: string[];
  peaks: { dof: string; contact: Maybe<[number, number]>; linear: Maybe<[number, number]> }[];
  points: Points;
  contacts: Contact[];
  motions: Motions;
  plan: Maybe<{ what: string; used: boolean; why: string }[]>;
  scene_text: Maybe<string>;
}

/** One entry a point in every list; rows are `[dof][point]`. */
export interface Points {
  parameter: number[];
  frequency: number[];
  status: string[];
  reason: Maybe<string>[];
  harmonics: number[];
  iterations: number[];
  residual: Maybe<number>[];
  truncation: Maybe<number>[];
  sampling: Maybe<number>[];
  solutions: Maybe<number>[];
  stable: Maybe<boolean>[];
  fold: boolean[];
  damping_ratio: Maybe<number>[];
  amplitude: Maybe<number>[][];
  phase: Maybe<number>[][];
  linear: Maybe<Maybe<number>[][]>;
  /** Solutions beside those of the points; one amplitude a dof. */
  others: { point: number; amplitude: Maybe<number>[] }[];
}

export interface Contact {
  name: string;
  directions: string[];
  state: Maybe<string>[];
  dissipation: Maybe<number>[];
  extrapolated: boolean[];
  amplitude: Maybe<number>[][];
}

export interface Motions {
  points: number[];
  samples: number;
  orders: number[];
  rows: number;
  force: "law" | "series";
  note: Maybe<string>;
  data: string;
}

/** One period of a point. */
export interface Period {
  /** Index of its point. */
  point: number;
  /** |W_k| in m, `[dof][order]`. */
  harmonics: Float32Array[];
  /** In m, `[dof][instant]`. */
  displacement: Float32Array[];
  /** One entry a direction of a contact, in the order of the contacts. */
  directions: { contact: number; name: string; displacement: Float32Array; force: Float32Array }[];
}

export function readPage(): Page {
  const text = document.getElementById("data")?.textContent ?? "";
  return JSON.parse(text) as Page;
}

/** The periods of a result, decoded once. */
export class Periods {
  private readonly numbers: Float32Array;

  constructor(private readonly result: Result) {
    const bytes = Uint8Array.from(atob(result.motions.data), (letter) => letter.charCodeAt(0));
    const view = new DataView(bytes.buffer);
    this.numbers = Float32Array.from({ length: bytes.length / 4 }, (_, i) => view.getFloat32(4 * i, true));
  }

  /** The period of the point nearest to `index` in the order of the result. */
  near(index: number): Period | undefined {
    const { points, samples, orders, rows } = this.result.motions;
    const dofs = this.result.dofs.length;
    const stride = dofs * (orders.length + samples) + 2 * rows * samples;
    let nearest = 0;
    points.forEach((point, i) => {
      if (Math.abs(point - index) < Math.abs((points[nearest] ?? 0) - index)) nearest = i;
    });
    const point = points[nearest];
    if (point === undefined) return undefined;
    let at = nearest * stride;
    const take = (count: number) => this.numbers.subarray(at, (at += count));
    const harmonics = this.result.dofs.map(() => take(orders.length));
    const displacement = this.result.dofs.map(() => take(samples));
    const directions = this.result.contacts.flatMap((contact, i) =>
      (contact.directions.length > 0 ? contact.directions : [""]).map((name) => ({
        contact: i,
        name,
        displacement: take(samples),
        force: take(samples),
      })),
    );
    return { point, harmonics, displacement, directions };
  }
}
