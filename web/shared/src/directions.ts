// Directions of axes that have no arrow, in degrees.

/** The direction of an axis that has no arrow, from its angle against x. */
export function direction(degrees: number): string {
  const angle = ((degrees % 180) + 180) % 180;
  if (angle < 22.5 || angle >= 157.5) return "nearly along x";
  if (angle < 67.5) return "between +x and +y";
  if (angle < 112.5) return "nearly along y";
  return "between −x and +y";
}

/** Smallest angle between two axes without arrows [°]. */
export function angleBetween(first: number, second: number): number {
  const difference = (((first - second) % 180) + 180) % 180;
  return Math.min(difference, 180 - difference);
}
