"""A SAT solver for questions about a graph."""


class Clauses:
    """A solver that loads only the parts of a graph that its questions need."""

    def __init__(self, graph):
        from pysat.solvers import Solver  # imported late: writing the pages does not need it

        self.graph = graph
        self.solver = Solver(name="cadical153")
        self.variables = {0: 1}  # {node: the solver's variable}
        self.top = 1
        self.add([-1])

    def fresh(self):
        self.top += 1
        return self.top

    def literal(self, literal):
        """The solver's literal for a literal of the graph; adds the clauses of all nodes below it."""
        waiting = [literal >> 1]
        while waiting:
            node = waiting.pop()
            if node in self.variables:
                continue
            fan = self.graph.fan[node] or ()
            if below := [one >> 1 for one in fan if one >> 1 not in self.variables]:
                waiting += [node, *below]
                continue
            self.variables[node] = self.fresh()
            if fan:
                y, a, b = self.variables[node], *map(self._of, fan)
                self.add([-y, a])
                self.add([-y, b])
                self.add([y, -a, -b])
        return self._of(literal)

    def _of(self, literal):
        variable = self.variables[literal >> 1]
        return -variable if literal & 1 else variable

    def add(self, literals):
        self.solver.add_clause(literals)

    def solve(self, assumptions):
        return self.solver.solve(assumptions=assumptions)

    def true_of(self, literals):
        """The keys of ``literals`` that are true in the solver's model; unloaded ones are left out."""
        true = set(self.solver.get_model())
        return [key for key, one in literals.items() if one >> 1 in self.variables and self._of(one) in true]
