"""Work-precision diagrams, and the picture of sights and hits, with matplotlib."""

import matplotlib
matplotlib.use('Agg')
import matplotlib.pyplot as plt
from matplotlib.collections import PolyCollection
from matplotlib.lines import Line2D

# family: (colour, marker, line)
STYLE = {
    'ours': ('#0050b0', 'o', '-'),
    'ours, budget': ('#6aa8e8', 'o', ':'),
    'paper A': ('#d06000', '^', ':'),
    'paper B': ('#e8a040', 'v', ':'),
    'static test at stamps': ('#000000', 'x', ''),
    'line of sight': ('#000000', '*', ''),
    'subdivision': ('#707070', 's', '-'),
    '4D intersection': ('#b050a0', 'D', '-'),
    'FCL naive': ('#806040', 's', '--'),
    'fcl::distance advancement': ('#2a8a3a', 'P', '-'),
    'FCL shape advancement': ('#60c060', 'X', ''),
    'Bullet convex sweep': ('#c02020', 'h', ''),
    'Bullet continuous': ('#e06080', 'H', ''),
    'Embree ray': ('#8030c0', 'p', ''),
}
FIGURES = {
    'error_time': ['efp_sphere', 'tumbling_10k', 'spinning_blade'],
    'error_time_shots': ['efp_point', 'efp_sphere', 'ballistic', 'high_spin'],
    'error_time_meshes': ['tumbling_1k', 'tumbling_10k', 'tumbling_100k', 'large_offset'],
    'error_time_hard': ['grazing_spheres', 'grazing_tip', 'sliding', 'spinning_blade'],
    'error_time_rest': ['deep_overlap', 'swarm'],
}
plt.rcParams.update({'font.size': 9, 'axes.titlesize': 10, 'svg.fonttype': 'none', 'svg.hashsalt': 'report'})


def value(row, key):
    return float(row[key]) if row[key] else None


def faults(row):
    """What a reader must know beside the point: how many hits it missed, made up, or could not decide."""
    counts = (('\u2212', row['missed']), ('+', row['false_hits']), ('?', row['undecided']))
    return ' '.join(sign + count for sign, count in counts if count != '0')


def panel(axes, scene, rows):
    """One scene. Filled: no fault. Hollow: with faults, and how many. In the strip: it found none of the hits."""
    ran = [row for row in rows if not row['reason']]
    floor = max([value(row, 'truth_error_s') or 0.0 for row in ran] + [1e-17])
    found = [row for row in ran if row['found'] != '0' and row['toi_error_max_s']]
    errors = [max(value(row, 'toi_error_max_s'), floor) for row in found]
    left, right = min(errors + [floor]) / 5, max(errors + [1e-3]) * 10
    strip = right * 30
    axes.axvspan(right, strip, color='0.94', zorder=0)
    axes.axvline(floor, color='0.6', linewidth=0.8, linestyle=':')
    axes.annotate('truth known to', (floor, 1), xycoords=('data', 'axes fraction'), xytext=(2, -3), textcoords='offset points',
                  rotation=90, ha='left', va='top', fontsize=6, color='0.5')
    for family, (colour, marker, line) in STYLE.items():
        points = []
        for row in (row for row in ran if row['family'] == family):
            time, fault = value(row, 'time_p50_s'), faults(row)
            bare = row in found
            worst = max(value(row, 'toi_error_max_s'), floor) if bare else (right * strip)**0.5
            middle = max(value(row, 'toi_error_p50_s'), floor) if bare else worst
            if row['hits'] == '0':
                continue
            hollow = bool(fault) and marker not in 'x*'
            axes.plot([middle, worst], [time, time], color=colour, linewidth=0.8, alpha=0.6, zorder=2)
            axes.plot(worst, time, marker, color=colour, markersize=5.5, markerfacecolor='white' if hollow else colour, zorder=4)
            if fault and bare:
                axes.annotate(fault, (worst, time), xytext=(4, 4), textcoords='offset points', fontsize=6.5, color=colour,
                              va='center', zorder=5)
            if bare:
                points.append((worst, time))
        if line and len(points) > 1:
            axes.plot(*zip(*points), line, color=colour, linewidth=1.1, zorder=1)
    axes.set_xscale('log')
    axes.set_yscale('log')
    axes.set_xlim(left, strip)
    axes.text((right * strip)**0.5, 0.985, 'found\nnone', transform=axes.get_xaxis_transform(), fontsize=6.5, ha='center', va='top',
              color='0.35')
    axes.set_title('%s  (%s hits of %s)' % (scene, ran[0]['hits'], ran[0]['queries']))
    axes.grid(True, which='major', color='0.9', linewidth=0.6)
    axes.set_axisbelow(True)
    return {row['family'] for row in ran}


def legend(figure, families):
    handles = [Line2D([], [], color=colour, marker=marker, linestyle=line, markersize=5.5, label=family)
               for family, (colour, marker, line) in STYLE.items() if family in families]
    handles.append(Line2D([], [], color='0.3', marker='o', markerfacecolor='white', linestyle='',
                          label='hollow: \u2212 missed, + false, ? undecided'))
    handles.append(Line2D([], [], color='0.3', linewidth=0.8, label='thin: median to worst error'))
    figure.legend(handles=handles, loc='lower center', ncol=5 if len(figure.axes) == 3 else 4, fontsize=8, frameon=False)


def save(figure, folder, name):
    paths = [folder / (name + ending) for ending in ('.png', '.svg')]
    figure.savefig(paths[0], dpi=110)
    figure.savefig(paths[1], metadata={'Date': None})
    plt.close(figure)
    return paths


def error_time(folder, name, scenes):
    columns = 3 if len(scenes) == 3 else 2
    lines = -(-len(scenes) // columns)
    below = 0.8 if columns == 3 else 0.95  # [inch] for the legend
    figure, grid = plt.subplots(lines, columns, figsize=(4.6 * columns, 3.6 * lines + below), squeeze=False)
    families = set()
    for axes, (scene, rows) in zip(grid.flat, scenes.items()):
        families |= panel(axes, scene, rows)
    for axes in grid[-1]:
        axes.set_xlabel('worst error of the time of impact [s]')
    for axes in grid.flat[len(scenes):]:
        axes.set_visible(False)
    for axes in grid[:, 0]:
        axes.set_ylabel('median CPU time per query [s]')
    figure.tight_layout(rect=(0, below / (3.6 * lines + below), 1, 1))
    legend(figure, families)
    return save(figure, folder, name)


def sights(folder, shots, triangles):
    """The tank from its left, where the shots come from, and from above: each shot's true contact and its line of sight's."""
    views = ((0, 2, 'seen from its left', 'z [m]'), (0, 1, 'seen from above', 'y [m], left'))
    figure, grid = plt.subplots(2, 1, figsize=(8.2, 7.6), gridspec_kw={'height_ratios': (2.5, 3.6)}, sharex=True)
    tint = {'hull': '#d4d8c4', 'turret': '#b8be9c', 'barrel': '#b0b0b0', 'stowage': '#d0c4b0'}
    names = sorted({shot['true_part'] for shot in shots} | {shot['sighted_part'] for shot in shots} - {''})
    colour = {name: plt.cm.tab10(index) for index, name in enumerate(names)}
    for axes, (u, v, title, label) in zip(grid, views):
        away = ({0, 1, 2} - {u, v}).pop()
        faces = sorted(triangles, key=lambda t: sum(float(t['xyz'[away] + str(k)]) for k in range(3)))  # nearest to the eye last
        corners = [[(float(t['xyz'[u] + str(k)]), float(t['xyz'[v] + str(k)])) for k in range(3)] for t in faces]
        axes.add_collection(PolyCollection(corners, facecolors=[tint.get(t['link'], '0.8') for t in faces], edgecolors='0.6',
                                           linewidths=0.25))
        for index, shot in enumerate(shots, 1):
            true = [float(shot['true_' + 'xyz'[k]]) for k in (u, v)]
            axes.plot(*true, 'o', markersize=11, color=colour[shot['true_part']], markeredgecolor='black', zorder=4)
            axes.annotate(str(index), true, fontsize=7, color='white', weight='bold', ha='center', va='center', zorder=5)
            if shot['sighted_part']:
                seen = [float(shot['sighted_' + 'xyz'[k]]) for k in (u, v)]
                axes.plot(*zip(true, seen), color='0.15', linewidth=0.9, linestyle=':', zorder=3)
                axes.plot(*seen, 'X', markersize=9, color=colour[shot['sighted_part']], markeredgecolor='black', zorder=4)
        axes.set_aspect('equal')
        axes.autoscale_view()
        axes.set_title('The demo\'s tank, ' + title)
        axes.set_ylabel(label)
    grid[0].invert_xaxis()
    grid[1].invert_yaxis()
    grid[1].set_xlabel('x [m], forward')
    handles = [Line2D([], [], marker='o', linestyle='', color='white', markeredgecolor='black', markersize=9, label='true first contact'),
               Line2D([], [], marker='X', linestyle='', color='white', markeredgecolor='black', markersize=9, label='line of sight')]
    handles += [Line2D([], [], marker='s', linestyle='', color=colour[name], label=name) for name in names]
    nothing = [str(index) for index, shot in enumerate(shots, 1) if not shot['sighted_part']]
    figure.tight_layout(rect=(0, 0.1, 1, 1))
    figure.legend(handles=handles, loc='lower center', ncol=4, fontsize=8, frameon=False, bbox_to_anchor=(0.5, 0.025))
    if nothing:
        figure.text(0.5, 0.012, 'The line of sight of shot %s meets nothing.' % ', '.join(nothing), ha='center', fontsize=8)
    return save(figure, folder, 'line_of_sight')


def draw(folder, scenes, shots, triangles):
    paths = []
    for name, wanted in FIGURES.items():
        chosen = {scene: scenes[scene] for scene in wanted if scene in scenes}
        if chosen:
            paths += error_time(folder, name, chosen)
    return paths + sights(folder, shots, triangles)
