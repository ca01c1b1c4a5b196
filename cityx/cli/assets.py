"""The commands of `cityx assets`; heavy modules are imported by the commands that need them."""
# Annotations stay values here: typer reads them at every start.

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from cityx.cli.terminal import Progress, echo_some
from cityx.errors import UsageError
from cityx.options import PIXELS, words_of

if TYPE_CHECKING:
    from cityx.assets.library.encoding import Encoder
    from cityx.assets.library.records import Catalogue

PROBLEMS = 1  # exit code: done, but something was refused or is wrong

assets = typer.Typer(
    help="Grow, import, search and place a library of assets.", no_args_is_help=True
)

LibraryFolder = Annotated[Path, typer.Argument(help="Folder of a library.")]
Out = Annotated[Path, typer.Option("-o", "--out", help="Folder of the library; made when absent.")]
EncoderName = Annotated[
    str, typer.Option(help="local-text (offline, not CLIP) or clip (needs weights).")
]
Weights = Annotated[str, typer.Option(help="Weights of CLIP ViT-L/14: a file, or a hub's name.")]
AllowHub = Annotated[bool, typer.Option("--allow-hub", help="Let weights be fetched.")]
Group = Annotated[str, typer.Option(help="buildings, plants, vehicles, people or furniture.")]


def _encoder(name: str, weights: str, allow_hub: bool) -> "Encoder":
    from cityx.assets.library.encoders import make_encoder

    return make_encoder(name, weights=weights, allow_hub=allow_hub)


@assets.command()
def grow(
    out: Out,
    count: Annotated[int, typer.Option(min=1, max=1_000_000, help="Assets to add.")] = 200,
    seed: Annotated[int, typer.Option(min=0, max=2**63 - 1, help="Key of all draws.")] = 0,
    groups: Annotated[
        str, typer.Option(help="Comma-separated: buildings, plants, vehicles, people, furniture.")
    ] = "buildings,plants,vehicles,people,furniture",
    uses: Annotated[
        str, typer.Option(help="Uses of buildings, comma-separated: house, flats, office, ...")
    ] = "",
    anew: Annotated[bool, typer.Option("--anew", help="Replace an older library.")] = False,
    encoder: EncoderName = "local-text",
    weights: Weights = "",
    allow_hub: AllowHub = False,
) -> None:
    """Materialise distinct assets from CityX's own generators."""
    from cityx.assets.library.grow import grow_library

    with Progress() as say:
        library = grow_library(
            out, count, _encoder(encoder, weights, allow_hub), seed=seed, groups=words_of(groups),
            uses=words_of(uses), anew=anew, say=say,
        )  # fmt: skip
    _tell(library.catalogue, f"{count} assets grown", out)


@assets.command("import")
def import_(
    folder: Annotated[Path, typer.Argument(help="Folder of .glb, .gltf, .obj, .blend, .usd*.")],
    out: Out,
    encoder: EncoderName = "local-text",
    weights: Weights = "",
    allow_hub: AllowHub = False,
) -> None:
    """Import a folder of models, measured; what cannot be used is refused by name."""
    from cityx.assets.library.importers import import_folder

    with Progress() as say:
        found = import_folder(folder, out, _encoder(encoder, weights, allow_hub), say=say)
    echo_some([f"note: {note}" for note in found.notes], "in the records of the library")
    for refusal in found.refusals:
        typer.echo(str(refusal))
    _tell(found.library.catalogue, f"{found.count} assets imported", out)
    if found.refusals:
        raise typer.Exit(PROBLEMS)


def _tell(catalogue: "Catalogue", done: str, out: Path) -> None:
    groups: dict[str, int] = {}
    for group in catalogue["group"].tolist():
        groups[group] = groups.get(group, 0) + 1
    held = ", ".join(f"{number} {group}" for group, number in sorted(groups.items()))
    typer.echo(f"{done}; {out} holds {held}")


@assets.command("list")
def list_(
    library: LibraryFolder,
    group: Group = "",
    style: Annotated[str, typer.Option(help="Style family.")] = "",
    use: Annotated[str, typer.Option(help="Use, such as house or office.")] = "",
    limit: Annotated[int, typer.Option(min=1, help="Most lines.")] = 20,
    as_json: Annotated[bool, typer.Option("--json", help="Print the records.")] = False,
) -> None:
    """List assets: name, group, style, use, size, height, triangles, licence."""
    from cityx.assets.library.store import open_library

    table = open_library(library).catalogue
    rows = [
        row for row in range(len(table))
        if all(not word or table[name][row] == word
               for name, word in (("group", group), ("style", style), ("use", use)))
    ]  # fmt: skip
    chosen = table.take(rows[:limit])
    if as_json:
        typer.echo(json.dumps(chosen.document(), indent=1))
        return
    for row in range(len(chosen)):
        typer.echo(_line(chosen, row))
    typer.echo(f"{min(limit, len(rows))} of {len(rows)} shown")


def _line(table: "Catalogue", row: int) -> str:
    from cityx.ids import id_text

    def of(name: str) -> Any:
        return table[name][row]

    return (
        f"{id_text(int(of('id')))}  {of('collection'):<34} {of('group'):<10} "
        f"{of('style') or '-':<14} {of('use') or '-':<10} "
        f"{of('length'):6.1f} x {of('width'):5.1f} x {of('height'):5.1f} m "
        f"{of('triangles'):>8}  {of('licence')}"
    )


@assets.command()
def show(
    library: LibraryFolder,
    name: Annotated[str, typer.Argument(help="Id, beginning of an id, or name of an asset.")],
) -> None:
    """Show the record of one asset as JSON."""
    from cityx.assets.library.store import open_library

    held = open_library(library)
    row = held.row_of(name)
    typer.echo(json.dumps({"group": held.catalogue["group"][row], **held.catalogue.record(row)},
                          indent=1))  # fmt: skip


@assets.command()
def search(
    library: LibraryFolder,
    text: Annotated[str, typer.Argument(help="What the asset is like.")],
    count: Annotated[int, typer.Option("-n", "--count", min=1, help="Most assets.")] = 10,
    group: Group = "",
    encoder: EncoderName = "local-text",
    weights: Weights = "",
    allow_hub: AllowHub = False,
) -> None:
    """Search by words; the encoder must be that of the library's index."""
    from cityx.assets.library.store import open_library

    held = open_library(library)
    made = _encoder(encoder, weights, allow_hub)
    among = held.catalogue["group"] == group if group else None
    rows, cosines = held.index.search(
        made.encode_text([text]), count, encoder=made.identity, among=among
    )
    for row, cosine in zip(rows[0].tolist(), cosines[0].tolist(), strict=True):
        typer.echo(f"{cosine:.3f}  {held.catalogue['collection'][row]}: "
                   f"{held.catalogue['description'][row]}")  # fmt: skip
    typer.echo(f"encoder: {held.encoder}")


@assets.command()
def place(
    city: Annotated[Path, typer.Argument(help="Folder of a built city.")],
    library: LibraryFolder,
    out: Annotated[Path, typer.Option("-o", "--out", help="Folder of the new city.")],
    mode: Annotated[str, typer.Option(help="fit, or paper: the published formulas.")] = "fit",
    text: Annotated[str, typer.Option(help="Words the assets should agree with.")] = "",
    share: Annotated[float, typer.Option(min=0.0, max=1.0, help="Share of buildings.")] = 1.0,
    glb: Annotated[bool, typer.Option("--glb/--no-glb", help="Write city.glb as well.")] = True,
) -> None:
    """Put assets on the lots of a built city; writes a new city and its report."""
    from cityx.assets.library.store import open_library
    from cityx.city.store import read_city, write_city
    from cityx.protocol import InputFiles, registry
    from cityx.protocol.running import Call, run_action

    open_library(library)  # a wrong folder is named before the work begins
    if out.exists() and (not out.is_dir() or any(out.iterdir())):
        raise UsageError(f"{out} exists already; give a new folder.")
    with Progress() as say:
        say("reading")
        held = read_city(city / "city")
        say("placing")
        call = Call("building/assets-v1", {"mode": mode, "description": text, "share": share})
        made = run_action(held, call, registry(), inputs=InputFiles((library,))).city
        say("writing")
        out.mkdir(parents=True, exist_ok=True)
        write_city(made, out / "city")
        if glb:
            from cityx.city.content import stored_hash
            from cityx.projects.views import renew_views

            renew_views(made, out, ["glb"], stored_hash(out / "city"), say=say)
        from cityx.projects.build import recheck

        recheck(out)
    typer.echo(made.notes[-1])
    typer.echo(str(out / "report.html"))


@assets.command()
def embed(
    library: LibraryFolder,
    encoder: EncoderName = "local-text",
    weights: Weights = "",
    allow_hub: AllowHub = False,
) -> None:
    """Rebuild the index of a library with an encoder."""
    from cityx.assets.library.store import embed_library, open_library

    made = embed_library(open_library(library), _encoder(encoder, weights, allow_hub))
    typer.echo(f"{len(made.catalogue)} assets embedded with {made.encoder}")


@assets.command()
def render(
    library: LibraryFolder,
    names: Annotated[list[str] | None, typer.Argument(help="Ids or names.")] = None,
    count: Annotated[
        int, typer.Option(min=1, help="Without names: so many that have no picture yet.")
    ] = 12,
    size: Annotated[str, typer.Option(help="Size in pixels, WxH.")] = "256x256",
    samples: Annotated[int, typer.Option(min=1, max=4096, help="Samples per pixel.")] = 16,
) -> None:
    """Render pictures of assets; a second or more each, so ask for few."""
    from cityx.assets.library.store import open_library
    from cityx.views.asset_pictures import render_assets

    held = open_library(library)
    rows = [held.row_of(name) for name in names] if names else [
        row for row in range(len(held.catalogue)) if not held.catalogue["render"][row]
    ][:count]  # fmt: skip
    if not rows:
        typer.echo("every asset has its picture")
        return
    with Progress() as say:
        pixels = PIXELS.read(size, "--size")
        _, paths = render_assets(held, rows, size=pixels, samples=samples, say=say)
    for path in paths:
        typer.echo(str(path))


@assets.command()
def check(
    library: LibraryFolder,
    deep: Annotated[
        bool, typer.Option("--deep/--fast", help="Compare the content of packs with its hashes.")
    ] = True,
) -> None:
    """Check records, files and index of a library."""
    from cityx.assets.library.store import check_library, open_library

    held = open_library(library)
    faults = check_library(held, deep=deep)
    for fault in faults:
        typer.echo(fault)
    typer.echo(f"{len(held.catalogue)} assets, {len(faults)} faults")
    if faults:
        raise typer.Exit(PROBLEMS)
