#!/usr/bin/env python3
"""Formulas of the documents become the TeX that is meant, or are refused; none is guessed."""

import pathlib
import sys
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(SOURCE / "docs/site"))
import formulas  # noqa: E402


class Formulas(unittest.TestCase):
    def test_become_tex(self):
        for line, tex in (
                ("M ẍ + B ẋ + K (x − x₀) = −F_h", r"M\,\ddot{x}+B\,\dot{x}+K\,(x-x_{0})=-F_{h}"),
                ("λ = ½ √(z_s² + 1)", r"\lambda =\tfrac12 \,\sqrt{z_{s}^{2}+1}"),
                ("J⁻ᵀ (a + b)", r"J^{-\mathsf{T}}\,(a+b)"),
                ("J = [[a, b], [c, d]]", r"J=\begin{bmatrix} a & b \\ c & d \end{bmatrix}"),
                ("A = B,  C = D", r"A=B,\quad C=D"),
                ("E = −∫₀ᵗ F_h·v dτ", r"E=-\int_{0}^{t}\,F_{h}\cdot v\,\mathrm{d}\tau "),
                ("θ = (Σ_j R_jᵀ)⁻¹", r"\theta =\left(\sum_{j}\,R_{j}^{\mathsf{T}}\right)^{-1}"),
                ("K_app = K", r"K_{\mathrm{app}}=K"),
                ("θ̈_i = 2 cos θ", r"\ddot{\theta }_{i}=2\,\cos \theta "),
        ):
            with self.subTest(line):
                self.assertEqual(formulas.to_tex(line), (tex, ""))

    def test_say_where_they_are_from_beside_themselves(self):
        self.assertEqual(formulas.to_tex("A = π λ_max  (eq. 3.15)"), (r"A=\pi \,\lambda_{\mathrm{max}}", "(eq. 3.15)"))
        self.assertEqual(formulas.to_tex("E = W  [J]"), ("E=W", "[J]"))
        self.assertEqual(formulas.to_tex("A = (B + C)"), ("A=(B+C)", ""))

    def test_what_is_not_known_is_refused(self):
        for line in ("a = ☃", "a = (b", "a = b]"):
            with self.subTest(line), self.assertRaises(formulas.NotAFormula):
                formulas.to_tex(line)

    def test_every_formula_of_the_theory_is_known(self):
        found = [line[2:] for page in sorted((SOURCE / "docs/theory").glob("*.md"))
                 for line in page.read_text().splitlines() if line.startswith("> ")]
        self.assertGreater(len(found), 60)
        for line in found:
            with self.subTest(line):
                self.assertTrue(formulas.is_formula(line))
                formulas.to_tex(line)


if __name__ == "__main__":
    unittest.main()
