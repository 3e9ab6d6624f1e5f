// The last seconds, in buckets of time that stay where they are, so that nothing shimmers: of each column the lowest and
// the highest sample.
import type { Frame } from "./stream";

export const span = 8; // [s]
const buckets = 400; // over the span
export const width = span / buckets; // [s]
const columns = 13;

export class Samples {
  newest = 0; // time of the newest sample [s]
  last = -1; // number of its bucket
  private readonly capacity = buckets + 2;
  private readonly lows = new Float32Array(this.capacity * columns);
  private readonly highs = new Float32Array(this.capacity * columns);
  private readonly numbers = new Int32Array(this.capacity).fill(-1); // of the bucket in each place

  clear(): void {
    this.numbers.fill(-1);
    this.last = -1;
    this.newest = 0;
  }

  /** The oldest bucket that is shown. */
  get first(): number {
    return Math.max(0, this.last - buckets);
  }

  add(frame: Frame): void {
    const { values } = frame;
    for (let i = 0; i < frame.samples; ++i) {
      const row = i * frame.columns;
      const time = frame.time + (values[row] as number);
      const number = Math.floor(time / width);
      const at = number % this.capacity;
      const place = at * columns;
      const fresh = this.numbers[at] !== number;
      this.newest = time;
      this.numbers[at] = this.last = number;
      for (let k = 1; k < columns; ++k) {
        const value = values[row + k] as number;
        if (fresh || value < (this.lows[place + k] as number)) this.lows[place + k] = value;
        if (fresh || value > (this.highs[place + k] as number)) this.highs[place + k] = value;
      }
    }
  }

  /** Of a bucket and a column; NaN where there is none. */
  low(number: number, column: number): number {
    const at = number % this.capacity;
    return this.numbers[at] === number ? (this.lows[at * columns + column] as number) : NaN;
  }

  high(number: number, column: number): number {
    const at = number % this.capacity;
    return this.numbers[at] === number ? (this.highs[at * columns + column] as number) : NaN;
  }
}
