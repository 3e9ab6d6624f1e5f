// Directions of undirected axes, in degrees.

/** The direction of an undirected axis, from its angle to x. The axes of the robot are not declared: no left or right. */
export function direction(degrees: number): string {
  const angle = ((degrees % 180) + 180) % 180;
  if (angle < 22.5 || angle >= 157.5) return "nearly along x";
  if (angle < 67.5) return "between +x and +y";
  if (angle < 112.5) return "nearly along y";
  return "between −x and +y";
}

/** Smallest angle between two undirected axes [°]. */
export function angleBetween(first: number, second: number): number {
  const difference = (((first - second) % 180) + 180) % 180;
  return Math.min(difference, 180 - difference);
}
