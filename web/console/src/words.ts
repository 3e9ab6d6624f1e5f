// Texts of elements, and times as they are read.

/** Writes only what has changed, so that a reader's place and a button's focus stay. */
export function text(element: HTMLElement, words: string): void {
  if (element.textContent !== words) element.textContent = words;
}

export const seconds = (value: number): string => `${Math.max(value, 0).toFixed(1)} s`;
export const clock = (value: number): string => `${Math.floor(value / 60)}:${String(Math.floor(value % 60)).padStart(2, "0")}`;
