"""Mutants of a module: its text with one expression replaced."""

import ast
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

COMPARISONS: dict[type[ast.cmpop], tuple[str, ...]] = {
    ast.Lt: ("<=", ">"),
    ast.LtE: ("<", ">="),
    ast.Gt: (">=", "<"),
    ast.GtE: (">", "<="),
    ast.Eq: ("!=",),
    ast.NotEq: ("==",),
    ast.Is: ("is not",),
    ast.IsNot: ("is",),
    ast.In: ("not in",),
    ast.NotIn: ("in",),
}
OPERATORS: dict[type[ast.operator], str] = {
    ast.Add: "-",
    ast.Sub: "+",
    ast.Mult: "/",
    ast.Div: "*",
    ast.Pow: "*",
    ast.BitAnd: "|",
    ast.BitOr: "&",
}
FUNCTIONS = {
    **{"maximum": "minimum", "minimum": "maximum", "max": "min", "min": "max", "any": "all", "all": "any"},
    **{"floor": "ceil", "cbrt": "sqrt", "sqrt": "cbrt", "abs": "negative", "log10": "log2", "degrees": "radians"},
    **{"multiply": "divide", "divide": "multiply", "add": "subtract", "round": "int"},
}
TEXTS = ("N_", "Meta")
"""Calls with texts for people; the tests of texts and translations guard them."""

REQUIRED = {
    "Check": (
        *("code", "name", "title", "unit", "kind", "group", "limit_name", "source", "tests", "consequence", "basis"),
        *("remedy", "demand", "limit", "relation"),
    )
}
"""Arguments that the module needs to be imported at all."""


@dataclass(frozen=True)
class Mutant:
    """Module's text with one change; `name` identifies it independently of other lines."""

    name: str
    path: Path
    line: int
    source: str


def mutants_of(module: str, path: Path) -> Iterator[Mutant]:
    """Mutants of a file of a module, in the order of its text."""
    source = path.read_text(encoding="utf-8")
    lines = source.splitlines(keepends=True)
    starts = [0]
    for line in lines:
        starts.append(starts[-1] + len(line.encode()))
    content = source.encode()
    seen: dict[str, int] = {}
    for scope, node, replacement in _changes(ast.parse(source)):
        begin = starts[node.lineno - 1] + node.col_offset
        end = starts[(node.end_lineno or node.lineno) - 1] + (node.end_col_offset or 0)
        old = content[begin:end].decode()
        if replacement.startswith(DROP):  # an argument goes with the comma after it
            rest = content[end:].decode()
            end += len((rest[: rest.index(",") + 1] if "," in rest[:2] else "").encode())
            replacement = ""
        name = f"{module} {scope}: {' '.join(old.split())} -> {' '.join(replacement.split()) or 'nothing'}"
        seen[name] = seen.get(name, 0) + 1
        numbered = f"{name} #{seen[name]}" if seen[name] > 1 else name
        yield Mutant(numbered, path, node.lineno, (content[:begin] + replacement.encode() + content[end:]).decode())


DROP = "\0drop"
Change = tuple[str, ast.expr | ast.stmt | ast.keyword, str]


def _changes(tree: ast.Module) -> Iterator[Change]:
    for statement in tree.body:
        yield from _walk(statement, "module")


def _walk(node: ast.AST, scope: str) -> Iterator[Change]:
    """Changes of a node and its parts; annotations, imports, docstrings and texts stay."""
    if isinstance(node, ast.Import | ast.ImportFrom | ast.JoinedStr):
        return
    if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
        return  # a docstring
    if isinstance(node, ast.Call) and _called(node) in TEXTS:
        return
    if isinstance(node, ast.FunctionDef | ast.ClassDef):
        scope = node.name if scope == "module" else f"{scope}.{node.name}"
    elif isinstance(node, ast.Call) and (code := _code(node)):
        scope = f"CHECKS[{code}]"
    yield from ((scope, place, text) for place, text in _replacements(node))
    for name, value in ast.iter_fields(node):
        if name in ("annotation", "returns", "decorator_list", "bases") or (
            isinstance(node, ast.ClassDef) and name == "keywords"
        ):
            continue
        for child in value if isinstance(value, list) else [value]:
            if isinstance(child, ast.AST):
                yield from _walk(child, scope)


def _code(node: ast.Call) -> str:
    """Code of the check that a call declares, itself or through a function; blank for any other call."""
    given = (keyword.value for keyword in node.keywords if keyword.arg == "code")
    return next(
        (value.value for value in given if isinstance(value, ast.Constant) and isinstance(value.value, str)), ""
    )


def _replacements(node: ast.AST) -> Iterator[tuple[ast.expr | ast.stmt | ast.keyword, str]]:
    match node:
        case ast.Compare(left=left, ops=[op], comparators=[right]):
            for other in COMPARISONS[type(op)]:
                yield node, f"({ast.unparse(left)}) {other} ({ast.unparse(right)})"
        case ast.BinOp(left=left, op=operator, right=right) if type(operator) in OPERATORS:
            yield node, f"(({ast.unparse(left)}) {OPERATORS[type(operator)]} ({ast.unparse(right)}))"
        case ast.AugAssign(target=target, op=operator, value=value) if type(operator) in OPERATORS:
            yield node, f"{ast.unparse(target)} {OPERATORS[type(operator)]}= {ast.unparse(value)}"
        case ast.BoolOp(op=both, values=values):
            word = " or " if isinstance(both, ast.And) else " and "
            yield node, "(" + word.join(f"({ast.unparse(value)})" for value in values) + ")"
        case ast.UnaryOp(operand=operand):
            yield node, f"({ast.unparse(operand)})"
        case ast.IfExp(test=test) | ast.If(test=test) | ast.While(test=test):
            yield from _opposite(test)
        case ast.comprehension(ifs=tests):
            for test in tests:
                yield from _opposite(test)
        case ast.Raise():
            yield node, "pass"
        case ast.Constant(value=bool() as value):
            yield node, str(not value)
        case ast.Constant(value=int() | float() as value):
            yield node, repr(value + 1)
        case ast.Constant(value=str() as value):
            yield node, repr(f"{value}X")
        case ast.Call():
            yield from _of_call(node)


def _opposite(test: ast.expr) -> Iterator[tuple[ast.expr, str]]:
    if not isinstance(test, ast.Compare | ast.UnaryOp):  # those have changes of their own
        yield test, f"(not ({ast.unparse(test)}))"


def _of_call(call: ast.Call) -> Iterator[tuple[ast.expr | ast.keyword, str]]:
    name = _called(call)
    if name in FUNCTIONS and isinstance(call.func, ast.Attribute):
        yield call.func, f"{ast.unparse(call.func.value)}.{FUNCTIONS[name]}"
    elif name in FUNCTIONS:
        yield call.func, FUNCTIONS[name]
    if name == "where" and len(call.args) == 3:
        test, first, second = map(ast.unparse, call.args)
        yield call, f"np.where({test}, {second}, {first})"
    required = REQUIRED.get(name, ())
    yield from (
        (keyword, DROP)
        for keyword in call.keywords
        if keyword.arg and keyword.arg not in required and not isinstance(keyword.value, ast.Constant)
    )


def _called(call: ast.Call) -> str:
    return call.func.attr if isinstance(call.func, ast.Attribute) else getattr(call.func, "id", "")
