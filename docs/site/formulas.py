"""Formulas as the documents write them, in Unicode on a line of their own, turned into TeX and set by KaTeX.

The documents have to be readable as they are, so their formulas are text: M ẍ + B ẋ + K (x − x₀) = −F_h. On the site the
same line is typeset. What cannot be parsed is an error, not a guess.
"""

import html
import json
import pathlib
import re
import subprocess
import unicodedata

KATEX = pathlib.Path("/usr/share/javascript/katex")  # Debian's libjs-katex
SUPERSCRIPTS = dict(zip("⁰¹²³⁴⁵⁶⁷⁸⁹⁺⁻⁼⁽⁾ⁿᵀᴴᵗᵈ", [*"0123456789+", "-", *"=()n", r"\mathsf{T}", r"\mathsf{H}", "t", "d"]))
SUBSCRIPTS = dict(zip("₀₁₂₃₄₅₆₇₈₉₊₋ₐₑₕᵢⱼₖₗₘₙₒₚₛₜₓ", [*"0123456789+", "-", *"aehijklmnopstx"]))
ACCENTS = {"̇": "dot", "̈": "ddot", "̂": "hat", "̄": "bar", "̃": "tilde"}
OPERATORS = {"sin", "cos", "exp", "det", "max", "min", "ln", "tan"}  # those that TeX knows by name
NAMED = {"tr", "vec", "diag", "turn", "atan", "Var", "mod", "atan2"}
SYMBOLS = {
    "−": "-", "·": r"\cdot ", "×": r"\times ", "⊗": r"\otimes ", "±": r"\pm ", "≤": r"\le ", "≥": r"\ge ", "≈": r"\approx ",
    "∝": r"\propto ", "⪰": r"\succeq ", "→": r"\to ", "∂": r"\partial ", "∫": r"\int ", "∮": r"\oint ", "∞": r"\infty ",
    "°": r"^{\circ}", "½": r"\tfrac12 ", "∈": r"\in ", "…": r"\dots ", "≠": r"\ne ", "∇": r"\nabla ", "Σ": r"\sum ",
    "∑": r"\sum ", "Π": r"\prod ", "%": r"\%", "Δ": r"\Delta ", "λ": r"\lambda ", "Λ": r"\Lambda ", "Ω": r"\Omega ",
    "ω": r"\omega ", "θ": r"\theta ", "τ": r"\tau ", "φ": r"\varphi ", "ψ": r"\psi ", "α": r"\alpha ", "β": r"\beta ",
    "γ": r"\gamma ", "δ": r"\delta ", "ε": r"\varepsilon ", "η": r"\eta ", "π": r"\pi ", "σ": r"\sigma ", "ζ": r"\zeta ",
    "ρ": r"\rho ", "μ": r"\mu ", "ν": r"\nu ", "Φ": r"\Phi ",
}
PLAIN = set("+-=<>,;:/|!.")
# What stands behind two spaces and says where the formula is from, or its unit.
REMARK = re.compile(r"\((?:eq\. |§|[A-E1-9]\.\d|[A-Z][a-z]+ )[^()]*(?:\([^()]*\)[^()]*)*\)[.,]?$|\[[A-Za-z%·/°²]+\]$")
FUNCTION_BEFORE = re.compile(r"(?<![A-Za-z])(?:sin|cos|exp|det|max|min|ln|tan)$")
SIMPLE_WORD = re.compile(r"[A-Za-z]+")


class NotAFormula(ValueError):
    """A character or a bracket that is not known here."""


def is_formula(line):
    return bool(re.search("[=∝≈⪰√Σ²]", line))


def matching(text, at):
    """Where the bracket that opens at `at` closes."""
    pairs, depth = {"(": ")", "[": "]", "{": "}"}, []
    for i in range(at, len(text)):
        if text[i] in pairs:
            depth.append(pairs[text[i]])
        elif text[i] in ")]}":
            if not depth or depth.pop() != text[i]:
                raise NotAFormula(f"brackets of '{text}'")
            if not depth:
                return i
    raise NotAFormula(f"'{text}' is not closed")


def split_at(text, separator):
    """`text` split where `separator` stands outside every bracket."""
    parts, depth, start = [], 0, 0
    for i, one in enumerate(text):
        depth += (one in "([{") - (one in ")]}")
        if one == separator and depth == 0:
            parts.append(text[start:i])
            start = i + 1
    return [*parts, text[start:]]


class Parser:
    """Turns one formula into TeX, atom by atom; an atom takes its accents, subscripts and superscripts along."""

    def __init__(self, text, inside=False):
        self.text, self.at, self.inside = unicodedata.normalize("NFD", text), 0, inside

    def all(self):
        out = []
        while self.at < len(self.text):
            out.append(self.item())
        return "".join(out)

    def peek(self, length=1):
        return self.text[self.at:self.at + length]

    def item(self):
        if self.peek(2) == "  ":
            self.at = len(self.text) - len(self.text[self.at:].lstrip(" "))
            return r"\qquad "
        if self.peek(2) == ", " and not self.inside:
            self.at = len(self.text) - len(self.text[self.at + 1:].lstrip(" "))
            return r",\quad "
        if self.peek() == " ":
            self.at += 1
            return self.gap()
        return self.with_marks(self.atom())

    def gap(self):
        """A space between two factors is seen; one beside a sign is TeX's business."""
        before, after = self.text[self.at - 2:self.at - 1], self.peek()
        signs = "=+−<>≤≥≈∝⪰·×⊗,;:([{|∫Σ∮→"
        if FUNCTION_BEFORE.search(self.text[:self.at - 1]):
            return ""
        return "" if before in signs or after in "=+−<>≤≥≈∝⪰·×⊗,;:)]}|→" else r"\,"

    def atom(self):
        one = self.peek()
        if one in "([":
            return self.bracket(one)
        if one == "√":
            return self.root()
        word = SIMPLE_WORD.match(self.text, self.at)
        if word:
            return self.word(word.group())
        number = re.compile(r"\d+(?:[.,]\d+)?").match(self.text, self.at)
        if number:
            self.at = number.end()
            return number.group()
        self.at += 1
        if one in SYMBOLS:
            return SYMBOLS[one]
        if one in PLAIN:
            return one
        if one in "{}":
            return "\\" + one
        raise NotAFormula(f"'{one}' in '{self.text}'")

    def bracket(self, one):
        end = matching(self.text, self.at)
        inside = self.text[self.at + 1:end]
        self.at = end + 1
        rows = [row.strip() for row in split_at(inside, ",")]
        if one == "[" and len(rows) > 1 and all(row.startswith("[") and row.endswith("]") for row in rows):
            return matrix([split_at(row[1:-1], ",") for row in rows])
        rows = split_at(inside, ";")
        if one == "[" and len(rows) > 1:
            return matrix([row.split() for row in rows])
        body = Parser(inside, inside=True).all()
        tall = "frac" in body or "sum" in body or "matrix" in body or "sqrt" in body
        left, right = ("\\left", "\\right") if tall else ("", "")
        return f"{left}{one}{body}{right}{')' if one == '(' else ']'}"

    def root(self):
        self.at += 1
        if self.peek() != "(":
            return rf"\sqrt{{{self.with_marks(self.atom())}}}"
        end = matching(self.text, self.at)
        inside = self.text[self.at + 1:end].strip()
        self.at = end + 1
        return rf"\sqrt{{{Parser(inside, inside=True).all()}}}"

    def word(self, word):
        if word == "atan" and self.text[self.at + 4:self.at + 5] == "2":
            self.at += 5
            return r"\operatorname{atan2}"
        following = self.text[self.at + len(word):]
        self.at += len(word)
        if word in OPERATORS:
            return rf"\{word} "
        if word in NAMED:
            return rf"\operatorname{{{word}}}"
        if len(word) == 1:  # d stands upright before what it is the differential of
            return r"\mathrm{d}" if word == "d" and following and following[0] in "θλτφω" else word
        if len(word) == 2 and (word[0] == "d" or word[1].isupper() or word[0].isupper()):
            self.at -= 1  # the second letter is an atom of its own, with its own marks
            return r"\mathrm{d}" if word[0] == "d" else word[0]
        # words of a sentence, with the spaces between them
        sentence = re.compile(r"(?: (?!\s)[a-z]{2,})*").match(self.text, self.at)
        self.at = sentence.end()
        space = " " if self.peek() == " " else ""
        return rf"\text{{ {word}{sentence.group()}{space}}}"

    def marks_of(self, table):
        out = []
        while self.peek() and self.peek() in table:
            out.append(table[self.peek()])
            self.at += 1
        return "".join(out)

    def script(self):
        """What stands behind _ or ^: braces, a star, or a run of letters."""
        self.at += 1
        if self.peek() == "{":
            end = matching(self.text, self.at)
            inside = self.text[self.at + 1:end]
            self.at = end + 1
            return Parser(inside).all()
        if self.peek() == "(":
            return self.bracket("(")
        run = re.compile(r"[A-Za-z]+|\d+|.[̀-ͯ]*").match(self.text, self.at)
        self.at = run.end()
        name = run.group()
        if name.isascii():
            return rf"\mathrm{{{name}}}" if len(name) > 2 else name
        return Parser(name).all()

    def with_marks(self, atom):
        accents = []
        while self.peek() and self.peek() in ACCENTS:
            accents.append(ACCENTS[self.peek()])
            self.at += 1
        for accent in accents:
            atom = rf"\{accent}{{{atom}}}"
        below, above = [], []
        while True:
            if self.peek() and self.peek() in SUBSCRIPTS:
                below.append(self.marks_of(SUBSCRIPTS))
            elif self.peek() and self.peek() in SUPERSCRIPTS:
                above.append(self.marks_of(SUPERSCRIPTS))
            elif self.peek() == "_":
                below.append(self.script())
            elif self.peek() == "^":
                above.append(self.script())
            elif self.peek() == "*":
                self.at += 1
                above.append("*")
            else:
                break
        if below:
            atom = f"{atom.rstrip()}_{{{','.join(below)}}}"
        if above:
            atom = f"{atom.rstrip()}^{{{' '.join(above)}}}"
        return atom


def matrix(rows):
    body = r" \\ ".join(" & ".join(Parser(entry.strip()).all() for entry in row) for row in rows)
    return rf"\begin{{bmatrix}} {body} \end{{bmatrix}}"


def to_tex(line):
    """The formula of one line as TeX, and its remark (source or unit) as text; the remark may be empty."""
    line = line.strip().replace("**", "")
    remark = REMARK.search(line)
    said = ""
    if remark and line[:remark.start()].endswith("  "):
        said, line = remark.group(), line[:remark.start()].rstrip()
    label = re.match(r"([a-z]{4,}) {2,}", line)  # "position  τ = …"
    prefix = ""
    if label:
        prefix, line = rf"\text{{{label.group(1)}}}\quad ", line[label.end():]
    return prefix + Parser(line).all(), said


def typeset(formulas):
    """HTML of TeX formulas, in order, by one run of KaTeX. What KaTeX refuses is an error."""
    program = (f"const katex = require({json.dumps(str(KATEX / 'katex.js'))});"
               "const given = JSON.parse(require('fs').readFileSync(0, 'utf8'));"
               "const set = (tex) => katex.renderToString(tex, {displayMode: true, throwOnError: true, strict: 'error'});"
               "process.stdout.write(JSON.stringify(given.map(set)));")
    process = subprocess.run(["node", "-e", program], input=json.dumps(formulas), capture_output=True, text=True,
                             check=False, timeout=60)
    if process.returncode != 0:
        raise NotAFormula(process.stderr)
    return json.loads(process.stdout)


def block(rendered, remarks):
    """One formula below the other, each with what is said of it at its right."""
    lines = "".join(f'<div class="formula-line"><div class="formula-itself">{body}</div>'
                    f'<div class="formula-remark">{html.escape(said)}</div></div>' for body, said in zip(rendered, remarks))
    return f'<div class="formula">{lines}</div>'
