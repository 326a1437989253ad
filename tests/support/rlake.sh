#!/bin/sh
# rlake.sh IN.tif E N LEVEL OUT.tif
# Runs GRASS r.lake headless in a throw-away XY location. OUT.tif: Float32 depth,
# wet <=> value > 0, dry/null = 0 (0 is also tagged as nodata). Silent on success.
# Exit: 0 ok, 2 usage, 3 GRASS missing, 4 seed dry / null / outside, 1 anything else.
# Needs only Debian's grass-core (no gdal-bin, no HOME, no prior GRASS set-up).
# r.lake never spreads water out of the region's last column, so it runs on the
# region grown by one (null) cell on each side; RLAKE_NOPAD=1 shows the raw behaviour.
set -eu
fail() { rc=$1; shift; echo "rlake.sh: $*" >&2; exit "$rc"; }
if [ "${1-}" != --inner ]; then
    [ $# -eq 5 ] || fail 2 "usage: rlake.sh IN.tif E N LEVEL OUT.tif"
    command -v grass >/dev/null 2>&1 || fail 3 "grass not found (apt-get install --no-install-recommends grass-core)"
    [ -r "$1" ] || fail 1 "cannot read $1"
    work=$(mktemp -d) || fail 1 "mktemp failed"
    trap 'rm -rf "$work"' EXIT
    trap 'exit 1' HUP INT TERM
    # nothing of the caller's set-up leaks in
    unset GISRC GISBASE GISDBASE LOCATION_NAME MAPSET GRASS_REGION WIND_OVERRIDE \
          GRASS_ADDON_BASE GRASS_BATCH_JOB GRASS_PYTHON PYTHONPATH PYTHONHOME
    export HOME="$work" TMPDIR="$work" GRASS_CONFIG_DIR="$work" LC_ALL=C.UTF-8 LANG=C.UTF-8 LANGUAGE=
    export GRASS_VERBOSE=0 GRASS_OVERWRITE=1 GDAL_PAM_ENABLED=NO
    self=$(readlink -f "$0"); in=$(readlink -f "$1")
    if grass --tmp-location XY --exec /bin/sh "$self" --inner "$in" "$2" "$3" "$4" "$work/out.tif" \
            >"$work/log" 2>&1 </dev/null && [ -s "$work/out.tif" ]; then
        cp -f "$work/out.tif" "$5" || fail 1 "cannot write $5"
        exit 0
    fi
    cat "$work/log" >&2
    ! grep -qE 'SEED-NULL|below earth surface|outside the current region' "$work/log" || fail 4 "seed is null, outside, or not below the level"
    fail 1 "GRASS run failed"
fi
# --- inside the GRASS session ---
shift
r.in.gdal -o input="$1" band=1 output=dem
g.region raster=dem
seed=$(r.what map=dem coordinates="$2,$3" null_value=null)
case $seed in '' | *\|null) echo SEED-NULL >&2; exit 1 ;; esac
[ -n "${RLAKE_NOPAD-}" ] || g.region grow=1
r.lake elevation=dem water_level="$4" coordinates="$2,$3" lake=lake
g.region raster=dem
r.out.gdal -c -m input=lake output="$5" format=GTiff type=Float32 nodata=0 createopt=COMPRESS=DEFLATE
