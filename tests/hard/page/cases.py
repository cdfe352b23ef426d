"""The hard cases as their tests report them, and as CSV."""
import csv
import re
from dataclasses import dataclass, field


@dataclass
class Beside:
    method: str
    answer: str
    inputs: int
    wrong: int
    seconds: float
    our_wrong: int
    our_seconds: float
    line: int = 0  # in the CSV file, the header is 1


@dataclass
class Case:
    name: str
    inputs: int
    wrong: int
    bound: str
    seconds: float
    share: float = 1
    beside: list = field(default_factory=list)
    line: int = 0

    @property
    def ran(self):
        return self.inputs > 0


def read_case(line):
    name, inputs, wrong, bound, seconds, *rest = line.rstrip("\n").split("\t")
    case = Case(name, int(inputs), int(wrong), bound, float(seconds), float(rest[1]) if len(rest) > 1 else 1)
    for text in rest[0].split(";") if rest and rest[0] else []:
        method, answer, count, bad, took, our_bad, our_took = text.split("|")
        case.beside.append(Beside(method, answer, int(count), int(bad), float(took), int(our_bad), float(our_took)))
    return case


def read_cases(lines, names):
    """All cases by name; those without a line have no inputs. Returns them and the suite of each."""
    suites = dict(reversed(line.rstrip("\n").split("\t")) for line in names)
    cases = {name: Case(name, 0, 0, "did not run", 0) for name in suites}
    for case in map(read_case, lines):
        cases[case.name] = case
    return list(cases.values()), suites


def row_of(case):
    found = re.match(r"hard_(\d+)_", case.name)
    return int(found[1]) if found else None


HEADER = ["case", "inputs", "wrong", "bound", "seconds", "share", "method", "answer", "method_wrong", "method_ns", "our_wrong",
          "our_ns"]


def write_csv(path, cases):
    """Writes a line for each test and for each ordinary method beside it, and notes the numbers of these lines."""
    line = 1
    with open(path, "w", encoding="utf-8", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(HEADER)
        for case in cases:
            line += 1
            case.line = line
            table.writerow([case.name, case.inputs, case.wrong, case.bound, case.seconds, case.share] + [""] * 6)
            for b in case.beside:
                line += 1
                b.line = line
                table.writerow([case.name, b.inputs, "", "", "", case.share, b.method, b.answer, b.wrong,
                                f"{1e9 * b.seconds / b.inputs:.4g}", b.our_wrong, f"{1e9 * b.our_seconds / b.inputs:.4g}"])
