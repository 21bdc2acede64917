"""The parameters of runs. Written by write_stubs.py."""

from collections.abc import Mapping
from os import PathLike
from typing import Any, TypedDict

from numpy.typing import ArrayLike

from ._native import Machine, Program

class MachineChanges(TypedDict, total=False):
    """Changes to a machine."""

    clock_ns: float | None
    """Length of a cycle (ns)."""

    word_bytes: int | None
    """Size of a word (bytes)."""

    fifo_words: int | None
    """Depth of each FIFO (words)."""

    link_mb_s: float | None
    """Rate of a link (Mbyte/s)."""

    rate_counts: str | None
    """What the rate of a link counts."""

    latency_cycles: int | None
    """Latency of a link (cycles)."""

    memory_words: int | None
    """Memory of a cell (words)."""

    x_fifo_words: int | None
    """Depth of each FIFO of X (words)."""

    y_fifo_words: int | None
    """Depth of each FIFO of Y (words)."""

    z_fifo_words: int | None
    """Depth of each FIFO of Z (words)."""

    message_us: float | None
    """Sending or taking a message (µs)."""

    host_filter_us: float | None
    """Host's time for testing a sample (µs)."""

    host_mask_us: float | None
    """Host's time for testing a sub-volume (µs)."""

    host_ray_us: float | None
    """Host's time for sending a ray (µs)."""

    host_hit_us: float | None
    """Host's time for shading a hit (µs)."""

    grid_start: float | None
    """Grid: start of a ray (µs)."""

    grid_voxel: float | None
    """Grid: step to a voxel (µs)."""

    slabs_start: float | None
    """Slabs: start of a ray (µs)."""

    slabs_polygon: float | None
    """Slabs: test of a polygon (µs)."""

    intersection_start: float | None
    """Intersection: start of a ray (µs)."""

    intersection_polygon: float | None
    """Intersection: test of a polygon (µs)."""

class MachineParameters(MachineChanges, total=False):
    """A machine, and changes to it."""

    on: str | None
    """Machine."""

    machine: str | PathLike[str] | Mapping[str, Any] | Machine | None
    """Machine."""

class RunParameters(MachineParameters, total=False):
    """Parameters of a run of primary rays."""

    size_factor: int | None
    """Size factor of the scene."""

    resolution: int | None
    """Slices of spheres and cones."""

    size: str | int | tuple[int, int] | None
    """Size of the image (pixels)."""

    rays: str | PathLike[str] | ArrayLike | None
    """Rays."""

    screen_rectangles: str | None
    """Screen rectangles."""

    order: str | None
    """Order of the rays."""

    mode: str | None
    """Mode."""

    program: str | PathLike[str] | Mapping[str, Any] | Program | None
    """Array program."""

    cells: int | None
    """Cells."""

    groups: int | None
    """Groups of cells."""

    partition: str | None
    """Partition of the scene."""

    numbering: str | None
    """Numbering of the groups."""

    grid_coefficient: float | None
    """Grid coefficient (voxels a polygon)."""

    mailbox: bool | None
    """Mailbox in the grid."""

    stop_words: int | None
    """Voxels ahead of the stop words."""

    forward_ahead: int | None
    """Rays passed on ahead."""

    rays_per_message: int | None
    """Rays in a message."""

    bounded_walk: bool | None
    """Walk bounded by the hit from the left."""

    masks: str | None
    """Masks of the sub-volumes."""

    edges: str | None
    """Edges of polygons."""

    cells_run: str | None
    """What the cells run."""

    cell_programs: str | PathLike[str] | None
    """Programs of the cells."""

    early_slabs: bool | None
    """Slabs' test ends early."""

    stepped_walk: bool | None
    """Walk adds up its steps."""

    instruction_limit: int | None
    """Most instructions for one ray."""

class ImageParameters(MachineParameters, total=False):
    """Parameters of a whole image."""

    size_factor: int | None
    """Size factor of the scene."""

    resolution: int | None
    """Slices of spheres and cones."""

    size: str | int | tuple[int, int] | None
    """Size of the image (pixels)."""

    screen_rectangles: str | None
    """Screen rectangles."""

    order: str | None
    """Order of the rays."""

    mode: str | None
    """Mode."""

    program: str | PathLike[str] | Mapping[str, Any] | Program | None
    """Array program."""

    cells: int | None
    """Cells."""

    groups: int | None
    """Groups of cells."""

    partition: str | None
    """Partition of the scene."""

    numbering: str | None
    """Numbering of the groups."""

    grid_coefficient: float | None
    """Grid coefficient (voxels a polygon)."""

    mailbox: bool | None
    """Mailbox in the grid."""

    stop_words: int | None
    """Voxels ahead of the stop words."""

    forward_ahead: int | None
    """Rays passed on ahead."""

    rays_per_message: int | None
    """Rays in a message."""

    bounded_walk: bool | None
    """Walk bounded by the hit from the left."""

    masks: str | None
    """Masks of the sub-volumes."""

    edges: str | None
    """Edges of polygons."""

    cells_run: str | None
    """What the cells run."""

    cell_programs: str | PathLike[str] | None
    """Programs of the cells."""

    early_slabs: bool | None
    """Slabs' test ends early."""

    stepped_walk: bool | None
    """Walk adds up its steps."""

    instruction_limit: int | None
    """Most instructions for one ray."""

    samples: int | None
    """Samples along a side of a pixel."""

    adaptive: bool | None
    """Samples only where they tell."""

    adaptive_by: str | None
    """What asks for samples."""

    threshold: int | None
    """Colours may differ by (of 255)."""

    depth: int | None
    """Reflections and refractions at the most."""

    min_contribution: float | None
    """Least share of a pixel that is followed."""

    timing: str | None
    """Timing."""

    policy: str | None
    """What the host sends next."""

    in_flight: int | None
    """Rays in the array at the most."""

    open_samples: int | None
    """Samples under way at the most."""

    rules: str | None
    """Rules that spare tests and rays."""

class ModelParameters(MachineParameters, total=False):
    """Parameters of a prediction."""

    size_factor: int | None
    """Size factor of the scene."""

    resolution: int | None
    """Slices of spheres and cones."""

    size: str | int | tuple[int, int] | None
    """Size of the image (pixels)."""

    rays: str | PathLike[str] | ArrayLike | None
    """Rays."""

    screen_rectangles: str | None
    """Screen rectangles."""

    order: str | None
    """Order of the rays."""

    mode: str | None
    """Mode."""

    program: str | PathLike[str] | Mapping[str, Any] | Program | None
    """Array program."""

    cells: int | None
    """Cells."""

    groups: int | None
    """Groups of cells."""

    partition: str | None
    """Partition of the scene."""

    numbering: str | None
    """Numbering of the groups."""

    grid_coefficient: float | None
    """Grid coefficient (voxels a polygon)."""

    masks: str | None
    """Masks of the sub-volumes."""

class FarmParameters(TypedDict, total=False):
    """Parameters of a farm."""

    size_factor: int | None
    """Size factor of the scene."""

    resolution: int | None
    """Slices of spheres and cones."""

    size: str | int | tuple[int, int] | None
    """Size of the image (pixels)."""

    grid_coefficient: float | None
    """Grid coefficient (voxels a polygon)."""

    machine: str | PathLike[str] | Mapping[str, Any] | Machine | None
    """Machine."""

    grid_start: float | None
    """Grid: start of a ray (µs)."""

    grid_voxel: float | None
    """Grid: step to a voxel (µs)."""

    slabs_start: float | None
    """Slabs: start of a ray (µs)."""

    slabs_polygon: float | None
    """Slabs: test of a polygon (µs)."""

    intersection_start: float | None
    """Intersection: start of a ray (µs)."""

    intersection_polygon: float | None
    """Intersection: test of a polygon (µs)."""

    samples: int | None
    """Samples along a side of a pixel."""

    depth: int | None
    """Reflections and refractions at the most."""

    min_contribution: float | None
    """Least share of a pixel that is followed."""

    tasks: int | None
    """Workers."""

    items: str | None
    """Work items."""

    tile: int | None
    """Side of a tile (pixels)."""

    hand_out: str | None
    """Handing out."""

    scene_by: str | None
    """The scene comes by."""

    rectangles: int | None
    """Rectangles of the made-up scene."""

    seed: int | None
    """Seed of the made-up scene."""

    processors: int | None
    """Processors."""

    memory_kbyte: int | None
    """Memory of a processor (kbyte)."""

    buses: int | None
    """Buses."""

    bus_mb_s: float | None
    """Rate of a bus (Mbyte/s)."""

    header_bytes: int | None
    """Header of a message (bytes)."""

    fixed_ms: float | None
    """Spent once (ms)."""

    per_cap_ms: float | None
    """Copy of the scene to one processor (ms)."""

    message_ms: float | None
    """Sending a message (ms)."""

    segment_ms: float | None
    """Set-up of a work item (ms)."""

    pixel_ms: float | None
    """Pixel of the made-up scene (ms)."""

    color_ms: float | None
    """Taking a colour (ms)."""

    shade_hit: float | None
    """Shading a hit (µs)."""

class CubeParameters(TypedDict, total=False):
    """Parameters of an image on a hypercube."""

    size_factor: int | None
    """Size factor of the scene."""

    resolution: int | None
    """Slices of spheres and cones."""

    size: str | int | tuple[int, int] | None
    """Size of the image (pixels)."""

    mode: str | None
    """Mode."""

    grid_coefficient: float | None
    """Grid coefficient (voxels a polygon)."""

    machine: str | PathLike[str] | Mapping[str, Any] | Machine | None
    """Machine."""

    clock_ns: float | None
    """Length of a cycle (ns)."""

    grid_start: float | None
    """Grid: start of a ray (µs)."""

    grid_voxel: float | None
    """Grid: step to a voxel (µs)."""

    slabs_start: float | None
    """Slabs: start of a ray (µs)."""

    slabs_polygon: float | None
    """Slabs: test of a polygon (µs)."""

    intersection_start: float | None
    """Intersection: start of a ray (µs)."""

    intersection_polygon: float | None
    """Intersection: test of a polygon (µs)."""

    samples: int | None
    """Samples along a side of a pixel."""

    depth: int | None
    """Reflections and refractions at the most."""

    min_contribution: float | None
    """Least share of a pixel that is followed."""

    rules: str | None
    """Rules that spare tests and rays."""

    shade_hit: float | None
    """Shading a hit (µs)."""

    sub_sample: float | None
    """Pixels of the sub-sample (%)."""

    cell_grid: int | None
    """Cells along a side."""

    cell_cuts: str | None
    """Cuts of the cells."""

    grids: str | None
    """Grids."""

    mapping: str | None
    """Mapping."""

    flow: str | None
    """Flow control."""

    queue_rays: int | str | None
    """Slots of a node (rays)."""

    grant: str | None
    """Granting of slots."""

    window: int | None
    """Pixels under way on a node."""

    termination: str | None
    """Termination."""

    pixel_order: str | None
    """Order of the pixels."""

    first: str | None
    """What is done first."""

    pixels: str | None
    """Who begins a pixel."""

    distribution: str | None
    """Distribution of the pixels."""

    page_bytes: int | None
    """Page of the shared memory (bytes)."""

    nodes: int | None
    """Nodes."""

    node_kbyte: int | None
    """Memory of a node (kbyte)."""

    program_kbyte: int | None
    """Program of a node (kbyte)."""

    short_bytes: int | None
    """Most bytes of a short message."""

    short_us: float | None
    """Short message (µs)."""

    short_wire_us: float | None
    """Short message under way (µs)."""

    long_us: float | None
    """Long message (µs)."""

    long_wire_us: float | None
    """Long message under way (µs)."""

    hop_us: float | None
    """Further link of a message's way (µs)."""

    byte_us: float | None
    """Byte of a message (µs)."""

    pixel_us: float | None
    """Beginning a pixel (µs)."""

    result_us: float | None
    """Taking a result (µs)."""

    fill_us: float | None
    """Making a list: a reference (µs)."""

    lookup_us: float | None
    """Access to another's page (µs)."""

    serve_us: float | None
    """Serving a page (µs)."""
