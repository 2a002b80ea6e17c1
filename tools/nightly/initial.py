"""Find the variables that only an `initial` block writes: constants, such as tables, kept in variables."""

from collections import defaultdict

import pyslang
from pyslang import analysis, ast, syntax


def only(paths, top, parameters):
    """Names of the variables below ``top``, in ``paths``, that only an `initial` block writes."""
    options = ast.CompilationOptions()
    options.topModules = {top}
    options.paramOverrides = [f"{name}={value}" for name, value in parameters.items()]
    compilation = ast.Compilation(pyslang.Bag([options]))
    for path in paths:
        compilation.addSyntaxTree(syntax.SyntaxTree.fromFile(str(path)))
    root = compilation.getRoot()
    compilation.getAllDiagnostics()  # forces full elaboration
    compilation.freeze()
    drivers = analysis.AnalysisManager()
    drivers.analyze(compilation)
    paths_of, once, often = defaultdict(list), set(), set()

    def see(symbol):
        if isinstance(symbol, ast.VariableSymbol):
            place = symbol.location.buffer, symbol.location.offset
            paths_of[place].append(symbol.hierarchicalPath.removeprefix(f"{top}."))
            # Of identical instances, slang reports the drivers for only one.
            for driver in drivers.getDrivers(symbol):
                (once if _initial(driver.containingSymbol) else often).add(place)

    root.visit(see)
    return {path for place in once - often for path in paths_of[place]}


def _initial(symbol):
    return isinstance(symbol, ast.ProceduralBlockSymbol) and symbol.procedureKind.name == "Initial"
