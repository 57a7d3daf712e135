#!/usr/bin/env python3
"""Every mutant of cargo-mutants in one build: `python3 .ci/mutants_at_once.py CRATE FILE...`, minutes instead of hours.

`cargo mutants` builds the crate anew for each mutant. This takes its list (`cargo mutants --list --json`), writes every mutant of the named files
into one copy of the workspace as a branch on the environment variable MUTANT, builds that once, asks each unit test (`--with PACKAGE`: and each
test of that package) which mutants it reaches, and runs each mutant against the tests that reach it until one fails. A mutant that does not compile
is taken out and called unviable, so that the first build is repeated a few times. Differences from
`cargo mutants`: doctests are not run, nor tests that take longer than `--longest` seconds; `a * b * c` with a plus in the first place is `(a + b) * c`, not `a + b * c`; and a few
mutants compile by themselves but not as a branch (in constants, in let chains, in a product that begins a range): they are called left out
or unviable here and want `cargo mutants --re`.

Needs cargo-mutants, and `pip install tree-sitter tree-sitter-rust`. Results are kept in OUT/results-CRATE.json after every file and
only what is not in it is run; delete it after a change of the code, delete the entries `missed` after a change of the tests (`--again` does).
"""

import argparse, json, os, re, shutil, subprocess, sys, time
from pathlib import Path

import tree_sitter
import tree_sitter_rust

SWITCH = '''//! Which mutant is on.
use std::io::Write as _;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering::Relaxed};
const UNREAD: u32 = u32::MAX;
const REACH: u32 = u32::MAX - 1;
static ON: AtomicU32 = AtomicU32::new(UNREAD);
static SEEN: [AtomicBool; 8192] = [const { AtomicBool::new(false) }; 8192];
/// Whether mutant n is on.
#[inline(always)]
pub fn on(n: u32) -> bool {
    let on = ON.load(Relaxed);
    if on >= REACH { read(n) } else { on == n }
}
#[cold]
fn read(n: u32) -> bool {
    // The environment is read once per mutant: this runs inside inner loops.
    if ON.load(Relaxed) == REACH && SEEN[n as usize].load(Relaxed) { return false; }
    let reach = std::env::var("MUTANT_REACH");
    if ON.load(Relaxed) == UNREAD {
        let number = std::env::var("MUTANT").ok().and_then(|v| v.parse().ok()).unwrap_or(REACH - 1);
        ON.store(if reach.is_ok() { REACH } else { number }, Relaxed);
    }
    if ON.load(Relaxed) != REACH { return ON.load(Relaxed) == n; }
    if let (Ok(path), false) = (reach, SEEN[n as usize].swap(true, Relaxed)) {
        let mut file = std::fs::OpenOptions::new().create(true).append(true).open(path).unwrap();
        file.write_all(format!("{n}\\n").as_bytes()).unwrap();
    }
    false
}
'''
PROFILE = '\n[profile.mutants]\ninherits = "test"\ndebug = false\n[profile.mutants.package.{crate}]\nopt-level = 2\n'
COPIED = ['Cargo.toml', 'Cargo.lock', 'clippy.toml', 'rustfmt.toml', 'crates', 'tests', 'xtask', 'data']


def branches(text, mutants):
    """The text of a file with all its mutants as branches, and the numbers of those that found their place."""
    raw = text.encode()
    lines, starts = raw.split(b'\n'), [0]
    for line in lines:
        starts.append(starts[-1] + len(line) + 1)
    places, used = {}, set()
    for n, m in mutants:
        at = m['span']['start']
        line = at['line'] - 1
        place = starts[line] + len(lines[line].decode()[: at['column'] - 1].encode())
        places.setdefault((m['genre'], place), []).append((n, m['replacement']))

    def here(genre, node):
        found = places.get((genre, node.start_byte), []) if node else []
        used.update(n for n, _ in found)
        return found

    def source(node):
        return raw[node.start_byte : node.end_byte].decode()

    def parts(node, start):
        out, at = [], start
        for child in node.children:
            if child.start_byte >= start:
                out += [raw[at : child.start_byte].decode(), emit(child)]
                at = child.end_byte
        return ''.join(out) + raw[at : node.end_byte].decode()

    def chosen(found, wrong, right):
        return ''.join(f'if crate::switch::on({n}) {{ ({wrong(r)}) }} else ' for n, r in found) + f'{{ ({right}) }}'

    def inside(node, byte):
        return node.start_byte <= byte < node.end_byte

    def nested(node):
        for child in node.children:
            yield child
            yield from nested(child)

    def emit(node):
        field, kind = node.child_by_field_name, node.type
        if kind in ('binary_expression', 'compound_assignment_expr'):
            left, sign, right = field('left'), field('operator'), field('right')
            if found := here('BinaryOperator', sign):
                # As text, so that `a || b || c` becomes `a || b && c`; but `a as f64 < b` would begin a list of types.
                cast = any(n.type == 'type_cast_expression' and n.end_byte == left.end_byte for n in [left, *nested(left)])
                first = f'({source(left)})' if cast else source(left)
                text = chosen(found, lambda r: f'{first} {r} {source(right)}', f'({emit(left)}) {source(sign)} {emit(right)}')
                return f'({text})' if kind == 'binary_expression' else f'{{ {text} }}'
        if kind == 'unary_expression' and (found := here('UnaryOperator', node)):
            return f'({chosen(found, lambda _: source(node.children[1]), source(node.children[0]) + emit(node.children[1]))})'
        if kind == 'function_item' and (body := field('body')):
            inner = [n for n in nested(body) if n.type == 'function_item']
            mine = [(n, r) for (genre, byte), found in places.items() for n, r in found
                    if genre == 'FnValue' and inside(body, byte) and not any(inside(i, byte) for i in inner)]
            used.update(n for n, _ in mine)
            early = ''.join(f' if crate::switch::on({n}) {{ return {r}; }}' for n, r in mine)
            return raw[node.start_byte : body.start_byte].decode() + '{' + early + parts(body, body.start_byte)[1:]
        if kind == 'match_arm':
            pattern = field('pattern')
            condition = pattern.child_by_field_name('condition')
            arm, guard = here('MatchArm', node), here('MatchArmGuard', condition)
            if arm or guard:
                end = condition.start_byte if condition else pattern.end_byte
                bare = raw[pattern.start_byte : end].decode().rstrip()
                wanted = [f'!crate::switch::on({n})' for n, _ in arm]
                if condition:
                    bare = bare.removesuffix('if')
                    wanted.append(f'({chosen(guard, lambda r: r, emit(condition))})')
                return f'{bare} if {" && ".join(wanted)}' + parts(node, pattern.end_byte)
        if kind in ('field_initializer', 'shorthand_field_initializer') and (found := here('StructField', node)):
            base = next(c for c in node.parent.children if c.type == 'base_field_initializer')
            name = source(field('field')) if kind == 'field_initializer' else source(node)
            value = emit(field('value')) if kind == 'field_initializer' else name
            return f'{name}: {chosen(found, lambda _: f"({source(base)[2:]}).{name}", value)}'
        return parts(node, node.start_byte) if node.children else source(node)

    root = tree_sitter.Parser(tree_sitter.Language(tree_sitter_rust.language())).parse(raw).root_node
    return raw[: root.start_byte].decode() + emit(root), used


def build(args, mutants, out):
    """Builds all mutants at once; returns the test programs with their packages' folders, the mutants that do not compile and those left out."""
    copy, unviable = out / 'workspace', set()
    shutil.rmtree(copy, ignore_errors=True)
    copy.mkdir(parents=True)
    for name in COPIED:
        (shutil.copytree if os.path.isdir(name) else shutil.copy)(name, copy / name)
    library = copy / 'crates' / args.crate / 'src'
    (library / 'switch.rs').write_text(SWITCH)
    with open(library / 'lib.rs', 'a') as f:
        f.write('\npub mod switch;\n')
    with open(copy / 'Cargo.toml', 'a') as f:
        f.write(PROFILE.format(crate=args.crate))
    while True:
        left_out = set()
        for file in args.files:
            mine = [(n, m) for n, m in enumerate(mutants) if m['file'] == file and n not in unviable]
            text, used = branches(open(file).read(), mine)
            left_out |= {n for n, _ in mine} - used
            (copy / file).write_text(text)
        packages = [word for package in args.packages for word in ('-p', package)]
        command = ['cargo', 'test', '--profile', 'mutants', '-p', args.crate, *packages, *([] if packages else ['--lib']), '--no-run',
                   '--message-format=json']
        done = subprocess.run(command, cwd=copy, stdout=subprocess.PIPE, text=True)
        messages = [json.loads(line) for line in done.stdout.splitlines() if line.startswith('{')]
        if done.returncode == 0:
            programs = [(m['executable'], Path(m['manifest_path']).parent) for m in messages if m.get('executable') and m['profile']['test']]
            return programs, unviable, left_out
        before = len(unviable)
        for m in (m['message'] for m in messages if m.get('reason') == 'compiler-message' and m['message']['level'] == 'error'):
            for span in (s for s in m['spans'] if s['is_primary']):
                # The switch that does not compile (in a constant), or the last one before what does not.
                raw, start = (copy / span['file_name']).read_bytes(), span['byte_start']
                own = re.match(rb'crate::switch::on\((\d+)\)', raw[start:])
                before_it = re.findall(rb'switch::on\((\d+)\)', raw[:start])
                if own or before_it:
                    unviable.add(int(own[1] if own else before_it[-1]))
        if len(unviable) == before:
            sys.exit(f'{done.stdout[-2000:]}\nno mutant explains these errors')


def run(test, limit, **variables):
    (program, folder), name = test
    started = time.time()
    try:
        done = subprocess.run([program, '--exact', name], cwd=folder, timeout=limit,
                              env={**os.environ, **variables, 'PROPTEST_FAILURE_PERSISTENCE': 'off'},
                              stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        return ('passed' if done.returncode == 0 else 'caught'), time.time() - started
    except subprocess.TimeoutExpired:
        return 'timeout', limit


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument('crate')
    parser.add_argument('files', nargs='+')
    parser.add_argument('--out', default='out/mutants-at-once')
    parser.add_argument('--with', dest='packages', action='append', default=[], help='packages whose tests are asked as well')
    parser.add_argument('--longest', type=float, default=5, help='seconds; tests that take longer are not asked')
    parser.add_argument('--again', action='store_true', help='run again what was missed')
    args = parser.parse_args()
    out = Path(args.out).resolve()
    listed = subprocess.run(['cargo', 'mutants', '--list', '--json', '-p', args.crate], capture_output=True, text=True, check=True)
    mutants = json.loads(listed.stdout)
    programs, unviable, left_out = build(args, mutants, out)

    store = out / f'results-{args.crate}.json'
    results = json.loads(store.read_text()) if store.exists() else {}
    if args.again:
        results = {name: r for name, r in results.items() if not r.startswith('missed')}
    tests = [(program, line.removesuffix(': test')) for program in programs
             for line in subprocess.run([program[0], '--list'], capture_output=True, text=True).stdout.splitlines() if line.endswith(': test')]
    reach, seconds = {}, {}
    for test in tests:
        seen = out / 'reach'
        seen.unlink(missing_ok=True)
        result, seconds[test] = run(test, 4 * args.longest, MUTANT_REACH=str(seen))
        if result == 'caught' or seconds[test] > args.longest:
            # A test of the sources themselves finds the branches.
            why = 'fails without any mutant' if result == 'caught' else f'longer than {args.longest} s'
            print(f'not asked: {test[1]}, {why}', flush=True)
            continue
        for n in seen.read_text().split() if seen.exists() else []:
            reach.setdefault(int(n), []).append(test)
    for file in args.files:
        counts = {}
        for n, m in enumerate(mutants):
            if m['file'] != file:
                continue
            name = m['name']
            if name not in results:
                if n in unviable or n in left_out:
                    results[name] = 'unviable' if n in unviable else 'left out'
                else:
                    results[name] = 'missed' if n in reach else 'missed (no test reaches it)'
                    for test in sorted(reach.get(n, []), key=seconds.get):
                        result, _ = run(test, max(20, 12 * seconds[test]), MUTANT=str(n))
                        if result != 'passed':
                            results[name] = f'{result} by {test[1]}'
                            break
            kind = results[name].split(' by ')[0].split(' (')[0]
            counts[kind] = counts.get(kind, 0) + 1
            if kind in ('missed', 'left out'):
                print(f'{results[name]}: {name}', flush=True)
        print(f'{file}: {sum(counts.values())} mutants, ' + ', '.join(f'{v} {k}' for k, v in sorted(counts.items())), flush=True)
        store.write_text(json.dumps(results, indent=1))


if __name__ == '__main__':
    main()
