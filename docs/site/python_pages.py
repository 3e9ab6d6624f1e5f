"""The reference of the Python package, from its docstrings: its functions as the build makes them, and its classes."""

import ast
import re

GROUPS = (("_functions", "mbk", "Functions"), ("study", "mbk.study", "mbk.study"), ("robot", "mbk.robot", "mbk.robot"),
          ("springs", "mbk.springs", "mbk.springs"), ("sensor", "mbk.sensor", "mbk.sensor"))
CLASSES = (("_recording", "Recordings"), ("_documents", "Results"), ("_live", "Watching a trial"),
           ("_errors", "Errors and warnings"))


def escaped(text):
    return re.sub(r"([*_<>|$#\[\]])", r"\\\1", text)


def inline(text):
    """A line of a docstring: what stands between `` or ` is code."""
    parts = re.split(r"(``.+?``|`.+?`)", text)
    return "".join(f"`{part.strip('`')}`" if k % 2 else escaped(part) for k, part in enumerate(parts))


def markdown(text):
    """A docstring in NumPy's style."""
    out, section, code = [], "", []
    lines = text.expandtabs().splitlines()
    at = 0

    def close():
        if code:
            out.extend(["", "```text", *code, "```", ""])
            code.clear()

    while at < len(lines):
        line = lines[at]
        below = lines[at + 1] if at + 1 < len(lines) else ""
        if line.strip() and re.fullmatch(r"\s*-{3,}\s*", below):
            close()
            section = line.strip()
            out += ["", f"**{section}**", ""]
            at += 2
            continue
        if section in ("Parameters", "Attributes", "Raises", "Returns") and line and not line.startswith(" "):
            name, _, kind = line.replace("\\", "").partition(" : ")
            out += ["", f"`{name}`" + (f" : {escaped(kind)}" if kind else "")]
            first = True
            while at + 1 < len(lines) and (lines[at + 1].startswith(" ") or not lines[at + 1].strip()):
                at += 1
                if lines[at].strip():
                    out.append((": " if first else "  ") + inline(lines[at].strip()))
                    first = False
        elif section in ("Notes", "Examples") and (line.startswith((" ", ">>>")) or code and line.strip()):
            code.append(line[4:] if line.startswith("    ") else line)
        else:
            if not line.strip() and code:
                code.append("")
            else:
                close()
                out.append(inline(line).replace("::", ":") if line.strip() else "")
        at += 1
    close()
    return "\n".join(out)


def signature(node):
    """As it is called, without types: those stand below."""
    positional = node.args.posonlyargs + node.args.args
    defaults = [None] * (len(positional) - len(node.args.defaults)) + node.args.defaults
    words = [f"{one.arg}={ast.unparse(default)}" if default else one.arg for one, default in zip(positional, defaults)
             if one.arg not in ("self", "cls")]
    if node.args.vararg:
        words.append("*" + node.args.vararg.arg)
    elif node.args.kwonlyargs:
        words.append("*")
    words += [f"{one.arg}={ast.unparse(default)}" if default else one.arg
              for one, default in zip(node.args.kwonlyargs, node.args.kw_defaults)]
    if node.args.kwarg:
        words.append("**" + node.args.kwarg.arg)
    return f"({', '.join(words)})"


def class_text(node):
    out = [f"\n### mbk.{node.name}\n", markdown(ast.get_docstring(node) or "")]
    for one in node.body:
        if isinstance(one, ast.FunctionDef) and not one.name.startswith("_") and ast.get_docstring(one):
            marks = [ast.unparse(mark) for mark in one.decorator_list]
            shown = f".{one.name}" + ("" if "property" in marks else signature(one))
            out += [f"\n#### `{shown}`\n", markdown(ast.get_docstring(one))]
    return "\n".join(out)


def pages(package):
    """Names of pages and their text.   package: mbk as the build makes it"""
    if not (package / "_functions.py").exists():
        raise SystemExit(f"{package} has no functions; build the target mbk_python_package")
    made, found = {}, {}
    for file, module, title in GROUPS:
        tree = ast.parse((package / f"{file}.py").read_text(encoding="utf-8"))
        functions = [one for one in tree.body if isinstance(one, ast.FunctionDef)]
        text = [f"# {title}\n", "Of the package [mbk](../guide/python.md); the options are those of the command."]
        for one in functions:
            text += [f"\n## {module}.{one.name}\n", f"```python\n{module}.{one.name}{signature(one)}\n```\n",
                     markdown(ast.get_docstring(one))]
        page = f"python/{module.split('.')[-1] if file != '_functions' else 'functions'}"
        made[page] = "\n".join(text) + "\n"
        found[page] = [(f"{module}.{one.name}", (ast.get_docstring(one) or "").splitlines()[0]) for one in functions]
    text = ["# Classes\n", "What the functions take and give."]
    exported = re.search(r"__all__ = \[(.*?)\]", (package / "__init__.py").read_text(encoding="utf-8"), re.DOTALL)[1]
    exported = set(re.findall(r'"(\w+)"', exported))
    for file, title in CLASSES:
        tree = ast.parse((package / f"{file}.py").read_text(encoding="utf-8"))
        text.append(f"\n## {title}\n")
        for one in tree.body:
            if isinstance(one, ast.ClassDef) and one.name in exported:
                text.append(class_text(one))
            elif isinstance(one, ast.FunctionDef) and one.name in exported | {"load", "live"} and ast.get_docstring(one):
                text += [f"\n### mbk.{one.name}{signature(one)}\n".replace("*", "\\*"), markdown(ast.get_docstring(one))]
    made["python/classes"] = "\n".join(text) + "\n"
    rows = "".join(f"| [`{name}`]({page.split('/')[1]}.md) | {escaped(line)} |\n"
                   for page, functions in found.items() for name, line in functions)
    names = "\n".join(page.split("/")[1] for page in made)
    made["python/index"] = (
        "# Python package\nEvery function and class of [`import mbk`](../guide/python.md), as `help()` shows them.\n\n"
        f"| Function | What it does |\n|---|---|\n{rows}\n"
        f"[Recordings, results, errors](classes.md)\n\n```{{toctree}}\n:hidden:\n\n{names}\n```\n")
    return made
