#!/usr/bin/env bash
# command_line.sh PARTPOSE: the command line as its users meet it: good input, and every kind of bad input, which must give
# one line on standard error and exit code 2, or a clean 'nothing recognized'.
set -uo pipefail
partpose=$(realpath "$1")
root=$(cd "$(dirname "$0")/.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export XDG_CACHE_HOME="$work/cache"
cd "$work"
failures=0
checks=0

fail() { echo "FAILED: $*"; failures=$((failures + 1)); }

# bad NAME PATTERN COMMAND...: exit code 2, one line, which holds PATTERN
bad() {
  local name=$1 pattern=$2
  shift 2
  checks=$((checks + 1))
  "$partpose" -q "$@" >out.txt 2>err.txt </dev/null
  local code=$?
  [ $code -eq 2 ] || fail "$name: exit code $code instead of 2: $(head -c 200 err.txt)"
  [ "$(wc -l <err.txt)" -eq 1 ] || fail "$name: $(wc -l <err.txt) lines instead of 1: $(head -c 400 err.txt)"
  grep -q -- "$pattern" err.txt || fail "$name: '$pattern' not in: $(cat err.txt)"
}

# good NAME COMMAND...: exit code 0
good() {
  local name=$1
  shift
  checks=$((checks + 1))
  "$partpose" -q "$@" >out.txt 2>err.txt </dev/null || fail "$name: exit code $?: $(cat err.txt)"
}

# nothing NAME COMMAND...: exit code 0 and a JSON line without a model
nothing() {
  local name=$1
  shift
  good "$name" "$@" --jsonl lines.jsonl
  grep -q '"model_name":null' lines.jsonl || fail "$name: something recognized: $(head -c 300 lines.jsonl)"
}

little_endian_32() { printf "\\x$(printf %02x $(($1 & 255)))\\x$(printf %02x $(($1 >> 8 & 255)))\\x$(printf %02x $(($1 >> 16 & 255)))\\x$(printf %02x $(($1 >> 24 & 255)))"; }

mkdir parts
cp "$root"/parts/bracket.stl "$root"/parts/link.stl parts/
frame="$root/scenes/bracket.png"
camera='"width": 640, "height": 480, "fx": 615, "fy": 615, "cx": 319.5, "cy": 239.5, "depth_scale_mm": 1'

echo "-- what works"
good "version" --version
good "help" --help
good "sensor --help" sensor --help
! grep -q 'partpose recognize' out.txt || fail "sensor --help has the examples of all: $(cat out.txt)"
for command in recognize view live dataset index evaluate captured scenes experiment sensor inspect symmetry ambiguity report config completion; do good "$command --help" $command --help; grep -q Example out.txt || fail "$command --help has no example"; done
good "recognize a frame" recognize --models parts --jsonl lines.jsonl --pictures pictures "$frame"
grep -q '"model_name":"bracket"' lines.jsonl || fail "the bracket was not recognized: $(cat lines.jsonl)"
for key in scene T_final match_distance icp_fitness time_ms; do grep -q "\"$key\":" lines.jsonl || fail "no $key in the JSON line"; done
[ -s pictures/bracket.png ] || fail "no picture"
good "dataset" dataset --models parts --config "$root/configs/dataset_ground_truth.json" --output dataset
for file in dataset.json descriptors models/0000/mesh.stl models/0001/views/0041.pcd; do [ -e "dataset/$file" ] || fail "dataset/$file is missing"; done
good "index" index --dataset dataset --config "$root/configs/pipeline_virtual.json"
for file in vfh.pcd vfh_config.json vfh_references.json; do [ -s "dataset/descriptors/$file" ] || fail "descriptors/$file is missing"; done
good "recognize by configuration" recognize --dataset dataset --config "$root/configs/pipeline_virtual.json" --jsonl lines.jsonl --output iterations dataset/models/0001/views/0007.pcd
grep -q '"model_name":"link"' lines.jsonl || fail "the link was not recognized: $(cat lines.jsonl)"
for file in result.json extras.json used_dataset.json used_pipeline_config.json; do [ -s iterations/*/$file ] || fail "iterations/*/$file is missing"; done
sed 's/"save_point_clouds": false/"save_point_clouds": true/' "$root/configs/pipeline_virtual.json" >clouds.json
good "all output files" recognize --dataset dataset --config clouds.json --output clouds dataset/models/0001/views/0007.pcd
for file in candidate_0.ply candidate_5.ply result_full.ply result_partial.pcd result_partial.ply scene_cloud_w_normals.pcd scene_cloud_w_normals.ply scene_original.ply; do [ -s clouds/*/$file ] || fail "clouds/*/$file is missing"; done
cat >small.json <<<'{"virtual_views_icosahedron": {"subdivide": 0}}'
good "small dataset" dataset --models parts --config small.json --output small
"$partpose" dataset --models parts/link.stl --config small.json --output one_part >out.txt
grep -q '^one_part: 1 part x 12 views in ' out.txt || fail "dataset says: $(cat out.txt)"
good "evaluate" evaluate --dataset small --test small --config "$root/configs/pipeline_virtual.json" --output evaluated --jsonl lines.jsonl
[ "$(wc -l <lines.jsonl)" -eq 24 ] || fail "evaluate: $(wc -l <lines.jsonl) lines instead of 24"
[ "$(ls evaluated/*/evaluation.json evaluated/*/evaluation_dataset.json | wc -l)" -eq 48 ] || fail "evaluation.json is missing"
stat -c '%n %y' dataset/descriptors/* >before.txt
good "dataset without configuration" recognize --dataset dataset --jsonl lines.jsonl --output by_dataset "$frame"
grep -q '"model_name":"bracket"' lines.jsonl || fail "the bracket was not recognized by the dataset: $(cat lines.jsonl)"
stat -c '%n %y' dataset/descriptors/* | cmp -s - before.txt || fail "the engine made the index anew"
[ -s by_dataset/*/result.json ] || fail "by_dataset/*/result.json is missing"
good "captured set" captured "$root/scenes" --models "$root/parts" --kind instance
good "captured set, lines" captured "$root/scenes" --models "$root/parts" --kind instance --jsonl -
! grep -v '^{.*}$' out.txt && grep -q 'pose right' err.txt || fail "captured --jsonl -: $(tail -n 1 out.txt)"
good "captured set with folders" captured "$root/scenes" --models "$root/parts" --kind instance --output captured
[ "$(ls captured/*/evaluation.json | wc -l)" -ge 1 ] || fail "captured: evaluation.json is missing"
for folder in iterations clouds evaluated captured; do
  good "report of $folder" report $folder
  [ "$(stat -c %s $folder/report.html)" -gt 500000 ] || fail "$folder/report.html is too small"
done
sed 's/"visualize_flag": false/"visualize_flag": true/; s/"pose_refinement": false/"pose_refinement": true/' "$root/configs/pipeline_virtual.json" >visualize.json
good "visualize" recognize --dataset dataset --config visualize.json --output visualized dataset/models/0001/views/0007.pcd
for file in report.html visualize_pose_refinement.png scene_preprocessed.ply extras.json; do [ -s visualized/*/$file ] || fail "visualized/*/$file is missing"; done
[ -s visualized/meshes/link_*.stl ] || fail "visualized/meshes/ is missing"

echo "-- bad reports"
bad "report of nothing" "no such folder" report nowhere
mkdir no_output && bad "report of another folder" "no iteration folder" report no_output
bad "report to nowhere" "cannot be written" report captured --output nowhere/report.html
bad "report without a limit" "limit_deg" report captured --limit-deg -1

echo "-- datasets of the BOP benchmark"
golden="$root/tests/bop_golden/mini_bop"
results=golden_minibop-test.csv
for command in "bop" "bop recognize" "bop score"; do good "$command --help" $command --help; grep -q Example out.txt || fail "$command --help has no example"; done
good "bop score" bop score "$golden" "$golden/$results" --image-width 640 --json scores.json
grep -q '^all  *-  *-  *34.5  *44.1$' out.txt || fail "bop score: $(cat out.txt)"
grep -q '"bop19_average_recall_mssd": 0.3454545454545' scores.json || fail "bop score --json: $(head -c 300 scores.json)"
bad "unknown image width" "give --image-width" bop score "$golden" "$golden/$results"
bad "no depth image" "000000.png: no such file" bop recognize "$golden" -o r.csv
[ ! -e r.csv ] || fail "a results file without results was left behind"
bad "no such BOP dataset" "nowhere: no such folder" bop score nowhere "$golden/$results"
bad "no such split" "train: no such folder" bop score "$golden" "$golden/$results" --split train
bad "no such results" "nowhere.csv: no such file" bop score "$golden" nowhere.csv --image-width 640
sed '3s/,0.404$/,late/' "$golden/$results" >$results && bad "damaged results" "line 3: time: 'late'" bop score "$golden" $results --image-width 640
cp -r "$golden" toy && chmod -R u+w toy
sed -i 's/"diameter"/"size"/' toy/models_eval/models_info.json && bad "models_info.json without a diameter" 'models_info.json: key "1.diameter" is missing' bop score toy "$golden/$results" --image-width 640
cp "$golden/models_eval/models_info.json" toy/models_eval/ && rm toy/models_eval/obj_000003.ply && bad "no model" "obj_000003.ply: no such file" bop score toy "$golden/$results" --image-width 640
bad "no BOP command" "subcommand" bop
good "symmetry" symmetry parts/link.stl --json
grep -q '"symmetries_discrete"' out.txt || fail "the link's symmetry was not found: $(cat out.txt)"
good "ambiguity" ambiguity parts/bracket.stl --camera "$root/scenes/bracket.camera.json" --subdivide 0 --jsonl lines.jsonl
grep -q "bracket" out.txt || fail "ambiguity lists nothing: $(cat out.txt)"
bad "symmetry tolerance" "must be positive" symmetry parts/link.stl --tolerance 0

echo "-- bad parts"
bad "no models" "no such file or folder" recognize --models nowhere "$frame"
mkdir empty && bad "folder without models" "no model files" recognize --models empty "$frame"
mkdir broken
head -c 1000 parts/link.stl >broken/a.stl && bad "truncated STL" "broken/a.stl" recognize --models broken "$frame"
{ head -c 80 parts/link.stl; little_endian_32 4000000000; tail -c +85 parts/link.stl; } >broken/a.stl && bad "huge count" "byte 80" recognize --models broken "$frame"
{ head -c 96 parts/link.stl; printf '\x00\x00\xc0\x7f'; tail -c +101 parts/link.stl; } >broken/a.stl && bad "NaN in an STL" "byte 96" recognize --models broken "$frame"
: >broken/a.stl && bad "empty STL" "broken/a.stl" recognize --models broken "$frame"
printf 'solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 zero\n' >broken/a.stl && bad "bad ASCII STL" "broken/a.stl" recognize --models broken "$frame"
bad "dataset of a broken STL" "broken/a.stl" dataset --models broken --output d2
[ ! -e d2 ] || fail "a half-made dataset was left behind"
bad "output that is no dataset" "holds other things" dataset --models parts --output "$root/configs"

echo "-- broken model files among good ones"
if python3 "$root/tests/make_broken_cad.py" many >counts.txt; then
  read -r broken_files good_files <counts.txt
  # A build without Assimp reads fewer of the good ones, and says so.
  unread=0
  for file in many/good_*; do "$partpose" -q inspect $file >out.txt 2>err.txt || { unread=$((unread + 1)); grep -q PARTPOSE_WITH err.txt || fail "$file: $(cat err.txt)"; }; done
  for command in "inspect many" "inspect many --json" "dataset --models many --config small.json --output many_set" "recognize --models many --jsonl many.jsonl $frame"; do
    checks=$((checks + 1))
    "$partpose" -q $command >out.txt 2>err.txt
    code=$?
    [ $code -eq 2 ] || fail "$command: exit code $code instead of 2"
    [ "$(wc -l <err.txt)" -eq $((broken_files + unread)) ] || fail "$command: $(wc -l <err.txt) lines for $((broken_files + unread)) broken files"
    for file in many/[0-9]*; do grep -q "^partpose: $file: ." err.txt || fail "$command: no line for $file"; done
    ! grep -qi 'bad_alloc\|std::\|terminate\|segmentation\|crashed\|fault of partpose' err.txt || fail "$command: an unclear line: $(grep -i 'bad_alloc\|std::\|terminate\|segmentation\|crashed' err.txt)"
    awk 'length > 300 { exit 1 }' err.txt || fail "$command: a line of more than 300 letters"
  done
  [ "$(ls many_set/models | wc -l)" -eq $((good_files - unread)) ] || fail "dataset: $(ls many_set/models | wc -l) parts of $((good_files - unread)) good files"
  [ "$(wc -l <many.jsonl)" -eq 1 ] || fail "recognize: no line for the frame"
  grep -q '"name": "good_binary"' many_set/dataset.json || fail "dataset: the good parts are not used"
fi
mkdir metres
printf 'solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 0.1 0 0\nvertex 0 0.1 0\nendloop\nendfacet\nfacet normal 0 1 0\nouter loop\nvertex 0 0 0\nvertex 0 0 0.1\nvertex 0.1 0 0\nendloop\nendfacet\nendsolid s\n' >metres/wedge.stl
good "a part in metres" recognize --models metres "$frame"
grep -q 'wedge.stl: is 0.1[0-9]* mm across; is it in metres' err.txt || fail "a part in metres: $(cat err.txt)"
mkdir centimetres && sed 's/0\.1/5/g' metres/wedge.stl >centimetres/wedge.stl
good "a part in centimetres" recognize --models centimetres "$frame"
grep -q 'wedge.stl: is [78][.0-9]* mm across; is it in inches or centimetres?' err.txt || fail "a part in centimetres: $(cat err.txt)"
good "inspect" inspect parts/link.stl --json
grep -q '"watertight": true' out.txt || fail "inspect: $(head -c 300 out.txt)"
good "inspect with views" inspect parts/bracket.stl --views --subdivide 0
grep -q 'ambiguous  0 of 12' out.txt || fail "inspect --views: $(cat out.txt)"
good "inspect, a few views by itself" inspect "$root/parts/t_plate.stl"
grep -q 'ambiguous  1 of 12 views do not tell the pose: ' out.txt || fail "inspect: $(cat out.txt)"
good "inspect without views" inspect parts/bracket.stl --no-views --json && ! grep -q ambiguous_views out.txt || fail "inspect --no-views: $(cat out.txt)"
good "inspect of many" inspect "$root"/parts/{bracket,link,flange,housing,t_plate}.stl
[ "$(grep -c 'ambiguous  not looked for: --views' out.txt)" -eq 5 ] || fail "inspect of many: $(cat out.txt)"
good "inspect and repair" inspect parts/link.stl --unit in --repair large.stl
good "what was repaired" inspect large.stl --json
grep -q '"warnings": \[\]' out.txt || fail "inspect of a repaired file: $(grep -A3 warnings out.txt)"
bad "repair of several" "one part, there are 2" inspect parts --repair x.stl
good "repair into a folder" inspect parts --repair repaired/
good "what was repaired" inspect repaired
[ "$(ls repaired | tr '\n' ' ')" = "bracket.stl link.stl " ] || fail "inspect --repair: $(ls repaired)"
bad "repair over the files" "write over the file itself" inspect parts --repair parts/
mkdir twice && cp parts/link.stl twice/ && printf 'OFF\n4 4 6\n0 0 0\n30 0 0\n0 40 0\n0 0 50\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n' >twice/link.off
bad "two parts of one name" 'link.stl: another model is already named "link": .*link.off' dataset --models twice --output d4
bad "chord tolerance" "must be positive" inspect parts/link.stl --chord-tolerance 0
bad "an image as a model" "bracket.png: is an image, not a model of a part; .*scenes" recognize --models "$frame" "$frame"
bad "a cloud as a model" "bracket__bracket.ply: has no triangles, is it a point cloud" recognize --models "$root/scenes/bracket__bracket.ply" "$frame"
bad "another file as a model" "README.md: is no model file by its name; models end with .stl, " recognize --models "$root/parts/README.md" "$frame"
mkdir -p above/below && cp parts/link.stl above/below/ && bad "models in a subfolder" "subfolders are not searched: give above/below itself" recognize --models above "$frame"
bad "split" "must be \"product\"" inspect parts/link.stl --split halves

echo "-- bad scenes"
bad "no scene file" "nowhere.png" recognize --models parts nowhere.png
bad "unknown kind of scene" "scene.xyz" recognize --models parts scene.xyz
bad "models without --models" "parts/link.stl: is a model of a part, not a scene; .*repeat it for each model" recognize --models parts/bracket.stl parts/link.stl "$frame" --jsonl stray.jsonl
[ ! -e stray.jsonl ] && [ ! -s out.txt ] || fail "recognized without a part that is meant: $(cat out.txt)"
bad "a folder as a scene" "is a folder, a scene is a file; give its files: .*scenes/\*.ply .*scenes/\*.png" recognize --models parts "$root/scenes"
cp "$frame" lonely.png && bad "no camera" "camera.json" recognize --models parts lonely.png
echo "{$camera}" >lonely.camera.json
good "camera beside" recognize --models parts lonely.png
echo "{${camera/\"fx\": 615, /}}" >lonely.camera.json && bad "camera without fx" '"fx" is missing' recognize --models parts lonely.png
echo "{${camera/, \"depth_scale_mm\": 1/}}" >lonely.camera.json && bad "camera without its scale" '"depth_scale_mm" is missing; write "depth_scale_mm": 1 where' recognize --models parts lonely.png
echo "{$camera, \"fz\": 1}" >lonely.camera.json && bad "unknown camera key" 'did you mean "fx"' recognize --models parts lonely.png
echo "{${camera/\"cx\": 319.5, \"cy\"/\"ppx\": 319.5, \"ppy\"}}" >lonely.camera.json && bad "another program's camera" 'like a file of RealSense; write {"width": 640, .*"cy": 239.5, "depth_scale_mm": 1}' recognize --models parts lonely.png
echo "{${camera/615/\"615\"}}" >lonely.camera.json && bad "wrong type" 'expected a number' recognize --models parts lonely.png
echo "{${camera/640/320}}" >lonely.camera.json && bad "other size" '640 x 480' recognize --models parts lonely.png
echo "{${camera/615/-615}}" >lonely.camera.json && bad "negative focal length" 'focal length' recognize --models parts lonely.png
echo "{$camera" >lonely.camera.json && bad "broken JSON" 'lonely.camera.json: line ' recognize --models parts lonely.png
echo "{${camera/319.5, \"cy\": 239.5/239.5, \"cy\": 319.5}}" >lonely.camera.json && good "a swapped principal point" recognize --models parts lonely.png lonely.png
[ "$(grep -c "lonely.png: its camera looks wrong: cx 239.5 and cy 319.5 .* are they swapped?" err.txt)" -eq 1 ] || fail "a swapped principal point: $(cat err.txt)"
echo "{$camera}" >lonely.camera.json
head -c 5000 "$frame" >lonely.png && bad "truncated PNG" "lonely.png: byte [0-9]*: truncated PNG$" recognize --models parts lonely.png
echo "this is no picture" >lonely.png && bad "not a PNG" "lonely.png" recognize --models parts lonely.png
cp pictures/bracket.png lonely.png && bad "8-bit PNG" "16-bit" recognize --models parts lonely.png
mkdir colours && cp pictures/bracket.png colours/ && bad "a picture without a camera" "colours/bracket.png: is a picture .*, not a depth image" recognize --models parts colours/bracket.png
printf 'ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\nproperty float z\nend_header\nabc' >s.ply
bad "huge PLY" "s.ply" recognize --models parts s.ply
printf 'VERSION 0.7\nFIELDS x y\nSIZE 4 4\nTYPE F F\nCOUNT 1 1\nWIDTH 1\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 1\nDATA ascii\n1 2\n' >s.pcd
bad "PCD without z" "s.pcd" recognize --models parts s.pcd
bad "one bad scene among good ones" "s.pcd" recognize --models parts --jsonl lines.jsonl "$frame" s.pcd "$frame"
[ "$(wc -l <lines.jsonl)" -eq 3 ] || fail "the good scenes were lost: $(cat lines.jsonl)"

for command in recognize view; do bad "$command, the unit of a depth image" "--units m is of clouds; .*depth_scale_mm" $command --models parts --units m "$frame"; done
good "the unit of clouds alone" recognize --models parts --units m "$frame" "$root/scenes/bracket__bracket.ply" --jsonl lines.jsonl
grep -q '"model_name":"bracket"' lines.jsonl && [ ! -s err.txt ] || fail "--units m of both: $(cat err.txt)"

echo "-- what may be the cause"
for scale in 0.1 10; do
  echo "{${camera/depth_scale_mm\": 1/depth_scale_mm\": $scale}}" >scaled.json
  nothing "depths x $scale" recognize --models parts --camera scaled.json "$frame"
  grep -q '"reason":"[^"]*; half of it is .* away: is it in another unit than stated?"' lines.jsonl || fail "depths x $scale: $(cat lines.jsonl)"
done
nothing "a cloud in mm where metres are expected" recognize --dataset dataset --config "$root/configs/pipeline_capture.json" "$root/scenes/bracket__bracket.ply"
grep -q '"reason":"0 of .* points are left .*; half of it is more than 5[0-9][0-9] m away: is it in another unit than stated?"' lines.jsonl || fail "a cloud in mm: $(cat lines.jsonl)"
header() { printf 'VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH %d\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS %d\nDATA ascii\n' "$1" "$1"; }
for ((i = 0; i < 5000; ++i)); do ((i * 7919 % 1009 >= 400)) || echo "$((i % 100 - 50)) $((i / 100 - 25)) 600"; done >points.txt
{ header "$(wc -l <points.txt)"; cat points.txt; } >thin.pcd
nothing "a thinned cloud" recognize --models parts thin.pcd
grep -q '"reason":"[^"]*; the cloud seems to be thinned' lines.jsonl || fail "a thinned cloud: $(cat lines.jsonl)"

echo "-- scenes that show nothing"
header 0 >empty.pcd
{ header 1; echo "1 2 600"; } >point.pcd
{ header 3; for _ in 1 2 3; do echo "nan nan nan"; done; } >nan.pcd
{ header 10000; for ((i = 0; i < 10000; ++i)); do echo "$((i % 100 * 4 - 200)) $((i / 100 * 4 - 200)) 600"; done; } >plane.pcd
{ header 500; for ((i = 0; i < 500; ++i)); do echo "$((i - 250)) 0 600"; done; } >line.pcd
{ header 500; for ((i = 0; i < 500; ++i)); do echo "5 5 600"; done; } >same.pcd
{ header 500; for ((i = 0; i < 500; ++i)); do echo "$((i % 30)) $((i / 30)) -600"; done; } >behind.pcd
for scene in empty point nan plane line same behind; do
  nothing "$scene, no configuration" recognize --models parts --pictures pictures $scene.pcd
  nothing "$scene, by configuration" recognize --dataset dataset --config clouds.json --output iterations $scene.pcd
done

"$partpose" -q recognize --models parts empty.pcd nan.pcd 2>err.txt
grep -q 'empty.pcd: is empty, it has no points' err.txt && grep -q 'nan.pcd: is empty, all of its 3 points are NaN' err.txt || fail "empty clouds: $(cat err.txt)"

echo "-- live"
mkdir frames
cp "$root/scenes/bracket.png" frames/a.png
cp "$root/scenes/empty_table.png" frames/b.png
cp "$root/scenes/bracket.camera.json" frames/camera.json
good "live" live frames --models parts --json --jsonl live.jsonl
[ "$(wc -l <out.txt)" -eq 2 ] && cmp -s out.txt live.jsonl || fail "live: $(head -c 300 out.txt)"
grep -q '^{"frame":0,"timestamp_s":.*"name":"frames/a.png","part":"bracket","camera_from_model":\[\[' out.txt || fail "live: $(head -c 300 out.txt)"
grep -q '^{"frame":1,.*"part":null,"camera_from_model":null,.*"detections":\[\]' out.txt || fail "live: $(tail -n 1 out.txt)"
good "live, lines" live frames --models parts --jsonl -
[ "$(grep -c '^{.*}$' out.txt)" -eq 2 ] && [ ! -e - ] || fail "live --jsonl -: $(tail -n 1 out.txt)"
good "live, by the recognizer" live frames --models parts --recognizer recognizer --frames 1
grep -q '^frames/a.png: bracket at (-5\.' out.txt && [ "$(wc -l <out.txt)" -eq 1 ] || fail "live: $(cat out.txt)"
echo nothing >frames/aa.png && bad "live, one bad file" "frames/aa.png" live frames --models parts
[ "$(wc -l <out.txt)" -eq 2 ] || fail "live: the good frames were lost: $(cat out.txt)"
rm frames/aa.png && cp pictures/bracket.png frames/a.color.png && cp pictures/bracket.png frames/b.color.png
good "live, pictures beside" live frames --models parts
[ "$(wc -l <out.txt)" -eq 2 ] && [ "$(grep -c "frames/.*.color.png: is a picture .* left out" err.txt)" -eq 1 ] || fail "live, pictures beside: $(cat err.txt)"
rm frames/*.color.png
"$partpose" live colours --models parts 2>err.txt
[ $? -eq 2 ] && grep -q 'colours: holds no 16-bit depth image' err.txt || fail "live of pictures: $(cat err.txt)"
mkdir no_camera && cp "$frame" no_camera/
bad "live, no camera" "bracket.png: no camera found; give it as .*(--camera)" live no_camera --models parts
good "live, a camera file" live no_camera --models parts --camera frames/camera.json
grep -q '^no_camera/bracket.png: bracket at' out.txt || fail "live --camera: $(cat out.txt)"
bad "live, a camera's camera" "realsense: --camera is of folders" live realsense --models parts --camera frames/camera.json
bad "live, no source" "no such source; give a folder" live relasense --models parts
bad "live of a file" "bracket.png: is a file, not a folder; partpose recognize" live "$frame" --models parts
bad "live, nothing there" "give --follow" live empty --models parts
bad "live, a camera followed" "only a folder can be followed" live realsense --follow --models parts
printf '#!/bin/sh\nPATH=/nowhere exec "%s" "$@"\n' "$partpose" >without_path && chmod +x without_path
partpose="$work/without_path" bad "live, a camera without Python" "which is not installed here: pip install" live realsense --models parts
mkdir path && printf '#!/bin/sh\necho "$@"\n' >path/partpose-live && chmod +x path/partpose-live
PATH="$work/path:$PATH" good "live, a camera" live realsense:12 --models parts --models x.stl --frames 3 --json --threads 2
grep -qx 'realsense:12 --recognizer engine --frames 3 --threads 2 --json --quiet --models parts x.stl' out.txt || fail "live as Python: $(cat out.txt)"

echo "-- output that cannot be written, told before the work"
: >a_file
none_done() { [ ! -s out.txt ] && [ ! -e nowhere ] || fail "$*: $(head -c 200 out.txt)"; }
for option in --output --pictures; do
  for folder in a_file a_file/below; do
    for command in "recognize --models parts $frame" "captured $root/scenes --models $root/parts"; do
      bad "$command $option $folder" "cannot be written: .*a_file is not a folder" $command $option $folder
      none_done "$command $option $folder"
    done
  done
done
for command in "recognize --models broken $frame" "captured $root/scenes --models broken" "evaluate --dataset nowhere --test small" "ambiguity broken --camera nowhere.json"; do
  bad "$command" "nowhere/lines.jsonl: cannot be written: there is no folder" $command --jsonl nowhere/lines.jsonl
done
bad "scenes" "cannot be written" scenes --models parts --output drawn_nowhere --pictures a_file
[ ! -e drawn_nowhere ] || fail "scenes were drawn before the pictures' folder was looked at"
bad "bop recognize" "nowhere/r.csv: cannot be written" bop recognize "$golden" -o nowhere/r.csv

echo "-- bad configurations"
config() { sed "$1" "$root/configs/pipeline_virtual.json" >c.json; }
by_config() { echo recognize --dataset dataset --config c.json dataset/models/0001/views/0007.pcd; }
config 's/"voxel_size": 1.0/"voxel_sise": 1.0/' && bad "unknown key" 'did you mean "preprocessing.voxel_size"\|did you mean "voxel_size"' $(by_config)
config 's/"voxel_size": 1.0/"voxel_size": "1"/' && bad "wrong type" 'preprocessing.voxel_size' $(by_config)
config 's/"voxel_size": 1.0/"voxel_size": -1/' && bad "out of range" 'voxel_size -1' $(by_config)
config 's/"global_descriptor": "vfh"/"global_descriptor": "vhf"/' && bad "unknown descriptor" 'did you mean "vfh"' $(by_config)
config '5d;6d' && head -c 100 c.json >c2.json && mv c2.json c.json && bad "not JSON" 'c.json: line ' $(by_config)
bad "no such configuration" "nowhere.json" recognize --dataset dataset --config nowhere.json s.pcd
bad "no such dataset" "nowhere" recognize --dataset nowhere --config clouds.json s.pcd
cp -r dataset half && rm half/dataset.json && bad "dataset without dataset.json" "dataset.json" index --dataset half
echo '{"models": []}' >half/dataset.json && bad "dataset.json without keys" 'is missing' index --dataset half
cp dataset/dataset.json half/ && rm half/models/0001/views/0003.pcd && rm -r half/descriptors && bad "dataset without a view" "0003.pcd" index --dataset half
echo '{"model_paths": ["nowhere.stl"]}' >list.json && bad "model list" "nowhere.stl" dataset --model-list list.json --output d3
echo '{"model_path": ["nowhere.stl"]}' >list.json && bad "model list key" "model_paths" dataset --model-list list.json --output d3

echo "-- synthetic scenes"
cat >scenes.json <<<'{"scene": {"camera": {"width": 160, "height": 120, "fx": 154, "fy": 154, "cx": 79.5, "cy": 59.5}}, "frames_per_scene": 2}'
good "scenes" scenes --models parts --frames 3 --config scenes.json --parts 2 --clutter 2 --pictures drawn --output drawn_scenes
for file in camera.json scenes.json test_targets_bop19.json models/models_info.json models/obj_000002.ply test/000001/scene_gt.json test/000001/scene_gt_info.json test/000001/depth/000001.png test/000002/depth/000000.png; do [ -s drawn_scenes/$file ] || fail "drawn_scenes/$file is missing"; done
[ "$(ls drawn | wc -l)" -eq 3 ] || fail "scenes: $(ls drawn | wc -l) pictures instead of 3"
good "scenes again" scenes --threads 1 --models parts --frames 3 --config scenes.json --parts 2 --clutter 2 --output drawn_again
diff -r drawn_scenes drawn_again >/dev/null || fail "scenes differ with one thread"
good "scenes replaced" scenes --models parts/link.stl --unknown parts/bracket.stl --frames 1 --config scenes.json --sensor none --seed 2 --hidden 0.2 0.4 --output drawn_scenes
[ -s drawn_scenes/unknown/000001/scene_gt.json ] || fail "the unknown part is missing"
[ ! -e drawn_scenes/test/000002 ] || fail "an older frame is left"
good "resting poses" scenes --models parts --list-poses
[ "$(grep -c '^link' out.txt)" -eq 4 ] || fail "link has $(grep -c '^link' out.txt) resting poses instead of 4"
good "scenes options" scenes --print-config
cp out.txt all.json
good "scenes options read" scenes --config all.json --print-config
diff out.txt all.json >/dev/null || fail "the printed options are not read back"
bad "scenes without parts" "--models" scenes --output s1
bad "scenes without output" "--output" scenes --models parts
bad "scenes, other folder" "other things" scenes --models parts --output parts
echo '{"scene": {"camera": {"elevation": [1, 2]}}}' >bad.json && bad "scenes, unknown key" 'did you mean "scene.camera.elevation_deg"\|did you mean "elevation_deg"' scenes --models parts --output s1 --config bad.json
bad "scenes, range" "0 to 0.99" scenes --models parts --hidden 0.5 0.2 --output s1
bad "scenes, sensor" "sonar" scenes --models parts --sensor sonar --output s1
bad "scenes, no frames" "1 or more" scenes --models parts --frames 0 --output s1
[ ! -e s1 ] || fail "s1 was written"

echo "-- experiments"
cat >experiment.json <<'SPEC'
{
  "name": "small",
  "groups": [{"name": "two parts", "parts": ["parts"]}],
  "protocols": [{"name": "views", "views": "small.json"}],
  "database": "small.json",
  "configurations": [{"name": "D", "pipeline": "${PARTPOSE_ROOT}/configs/pipeline_virtual.json"}]
}
SPEC
bad "experiment, variable not set" "PARTPOSE_ROOT is not set" experiment experiment.json -o experiment
export PARTPOSE_ROOT="$root"
good "experiment" experiment experiment.json -o experiment
grep -q "^two parts / views / D / vfh  *24 " out.txt || fail "experiment: $(cat out.txt)"
[ "$(wc -l <experiment/frames.jsonl)" -eq 24 ] || fail "experiment: $(wc -l <experiment/frames.jsonl) lines instead of 24"
for file in experiment.json tables.md tables.json recognition.csv poses.csv confusion.csv errors.csv times.csv two-parts--views-rotation.svg two-parts--views-translation.svg; do [ -s experiment/$file ] || fail "experiment/$file is missing"; done
head -n 20 experiment/frames.jsonl >half.jsonl && sed -n 21p experiment/frames.jsonl | head -c 500 >>half.jsonl && cp experiment/recognition.csv whole.csv && mv half.jsonl experiment/frames.jsonl
good "experiment, goes on" experiment experiment.json -o experiment
[ "$(grep -c '}$' experiment/frames.jsonl)" -eq 24 ] || fail "experiment: $(grep -c '}$' experiment/frames.jsonl) frames instead of 24"
cp experiment/frames.jsonl all.jsonl
cmp -s whole.csv experiment/recognition.csv || fail "a run that was stopped gives another table: $(cat experiment/recognition.csv)"
echo "notes" >parts/README.md
good "experiment, finished" experiment experiment.json -o experiment
cmp -s all.jsonl experiment/frames.jsonl || fail "frames of a finished experiment were repeated"
rm parts/README.md && cp "$root/parts/t_plate.stl" parts/ && bad "experiment, another part" "t_plate.stl: has changed since" experiment experiment.json -o experiment
rm parts/t_plate.stl
spec() { sed "$1" experiment.json >e.json; }
spec 's/"small"/"other"/' && bad "another experiment" "holds another experiment" experiment e.json -o experiment
bad "folder of something else" "no experiment's folder" experiment experiment.json -o parts
spec 's/"database"/"databse"/' && bad "experiment, unknown key" 'did you mean "database"' experiment e.json -o e1
spec 's/"database": "small.json"/"descriptors": ["vhf"]/' && bad "experiment, unknown descriptor" 'did you mean "vfh"' experiment e.json -o e1
spec 's/"views": "small.json"/"views": "small.json", "captured": "scenes"/' && bad "experiment, two kinds of scenes" 'give one of "views", "captured" and "scenes"' experiment e.json -o e1
spec 's/"groups": .*/"groups": [],/' && bad "experiment, no groups" "groups: give at least one" experiment e.json -o e1
spec 's/"parts": .*/"parts": []}],/' && bad "experiment, no parts" "parts: give at least one" experiment e.json -o e1
head -c 60 experiment.json >e.json && bad "experiment, not JSON" "e.json: line " experiment e.json -o e1
bad "experiment, no file" "nowhere.json" experiment nowhere.json -o e1
bad "experiment without output" "--output" experiment experiment.json
[ ! -e e1 ] || fail "e1 was written"
spec 's/"views": "small.json"/"views": "nowhere.json"/' && bad "experiment, no views" "nowhere.json" experiment e.json -o e1
spec 's/\["parts"\]/["nowhere.stl"]/' && bad "experiment, no such part" "nowhere.stl" experiment e.json -o e1
good "report of an experiment" report experiment

echo "-- configurations, written and explained"
for kind in pipeline dataset scenes experiment sensor camera; do
  good "config $kind" config $kind -o default_$kind.json
  grep -q '^ *// ' default_$kind.json || fail "config $kind explains nothing"
  good "config $kind as JSON" config $kind --json
  good "config $kind --keys" config $kind --keys
  while read -r key; do
    name=${key##*.}
    grep -q "\"$name\"\|\.$name (" default_$kind.json || fail "config $kind: no $key"
  done <out.txt
done
good "config, default kind" config && cmp -s out.txt default_pipeline.json || fail "config does not write the pipeline's"
good "the written pipeline is read" recognize --dataset dataset --config default_pipeline.json --jsonl lines.jsonl dataset/models/0001/views/0007.pcd
grep -q '"model_name":"link"' lines.jsonl || fail "the written pipeline recognizes nothing: $(cat lines.jsonl)"
good "the written dataset is read" dataset --models parts --config default_dataset.json --set virtual_views_icosahedron.subdivide=0 --output written_set
[ "$(ls written_set/models/0000/views | wc -l)" -eq 12 ] || fail "--set: $(ls written_set/models/0000/views | wc -l) views instead of 12"
good "the written scenes are read" scenes --config default_scenes.json --print-config
good "config of a file" config pipeline --config "$root/configs/pipeline_capture.json" --json
grep -q '"scale_flag": true' out.txt || fail "config --config: the file's values are not there"
grep -q '"crh_peaks": 4' out.txt || fail "config --config: the defaults are not filled in"
good "explain" config --explain voxel_size
[ "$(grep -c '^pipeline: [a-z_]*.voxel_size  (float, default: ' out.txt)" -eq 2 ] || fail "explain: $(cat out.txt)"
good "explain a section" config pipeline --explain preprocessing
grep -q 'preprocessing.xyz_limits  (6 x float' out.txt || fail "explain: $(cat out.txt)"
good "explain as JSON" config --explain vfh.k_nn --json
grep -q '"default": 6' out.txt || fail "explain --json: $(cat out.txt)"
bad "explain, a key like no other" 'unknown key "nosuchkey"; partpose config --keys lists all' config --explain nosuchkey
bad "explain, unknown key" 'did you mean "preprocessing.voxel_size" or "pose_refinement.voxel_size"' config --explain voxel_sise
bad "config, unknown kind" 'did you mean "pipeline"' config pipelin
bad "config of no file" "nowhere.json" config pipeline --config nowhere.json
bad "config to nowhere" "cannot be written" config --output nowhere/c.json
if command -v python3 >/dev/null; then
  checks=$((checks + 1))
  "$root/script/build_docs_configuration" --check "$partpose" >out.txt 2>&1 || fail "docs/: $(cat out.txt)"
fi

echo "-- overrides"
good "set" index --dataset small --set vfh.k_nn=3 --set database.noise_levels_mm=0
good "set a configuration's key" recognize --dataset dataset --config "$root/configs/pipeline_virtual.json" --set vfh.k_nn=2 --set debug.save_extras_json=true --output overridden dataset/models/0001/views/0007.pcd
[ "$(grep -c '"view_id"' overridden/*/extras.json)" -eq 2 ] || fail "--set vfh.k_nn=2: $(grep -c '"view_id"' overridden/*/extras.json) candidates"
good "set of evaluate" evaluate --dataset small --test small --set vfh.k_nn=1 --json
grep -q '"frames": 24' out.txt || fail "evaluate --json: $(head -c 300 out.txt)"
good "set of scenes" scenes --print-config --set scene.parts=2,3 --set sensor.model=none
grep -A2 '"parts"' out.txt | grep -q 2 && grep -q '"model": "none"' out.txt || fail "scenes --set: $(head -c 300 out.txt)"
good "set in config" config dataset --json --set tag=mine --set virtual_depth_camera.noise.stereo.baseline_mm=95
grep -q '"tag": "mine"' out.txt && grep -q '"baseline_mm": 95.0' out.txt || fail "config --set: $(cat out.txt)"
set_pipeline() { echo recognize --dataset dataset --config "$root/configs/pipeline_virtual.json" dataset/models/0001/views/0007.pcd --set; }
bad "set, unknown key" 'set vfh.knn=3: unknown key "vfh.knn"; did you mean "vfh.k_nn"' $(set_pipeline) vfh.knn=3
bad "set, key without its section" 'did you mean "preprocessing.scale_flag"' $(set_pipeline) scale_flg=true
bad "set, wrong type" 'set vfh.k_nn=many: key "vfh.k_nn": expected a whole number, got string "many"' $(set_pipeline) vfh.k_nn=many
bad "set, not a flag" 'expected true or false, got string "yes"' $(set_pipeline) preprocessing.scale_flag=yes
bad "set, too few" 'expected an array of 6' $(set_pipeline) preprocessing.xyz_limits=0,1
bad "set, out of range" 'set preprocessing.voxel_size=-1: .*voxel_size' $(set_pipeline) preprocessing.voxel_size=-1
bad "set, unknown descriptor" 'did you mean "vfh"' $(set_pipeline) global_descriptor=vhf
bad "set, no value" 'expected KEY=VALUE' $(set_pipeline) vfh.k_nn
bad "set without a configuration" 'give one with --config' recognize --models parts --set vfh.k_nn=3 "$frame"
bad "set of dataset" 'did you mean "virtual_views_icosahedron.subdivide"' dataset --models parts --output s2 --set virtual_views_icosahedron.subdivde=2
bad "set of an experiment" 'did you mean "limit_mm"' experiment "$root/experiments/ground_truth.json" --output s2 --set limit_m=3
[ ! -e s2 ] || fail "s2 was written"

echo "-- recognizers"
for recognizer in engine recognizer; do
  good "$recognizer" recognize --models parts --recognizer $recognizer --json "$frame"
  [ "$(wc -l <out.txt)" -eq 1 ] || fail "recognize --json: $(wc -l <out.txt) lines"
  grep -q '"model_name":"bracket"' out.txt || fail "$recognizer: $(head -c 300 out.txt)"
  grep -q '"detections":\[{"model_name":"bracket","T":\[\[.*"score":' out.txt || fail "$recognizer lists no detections: $(head -c 300 out.txt)"
  good "captured by the $recognizer" captured "$root/scenes" --models "$root/parts" --kind instance --recognizer $recognizer --json
  grep -q '"pose_right"' out.txt || fail "captured --json: $(head -c 300 out.txt)"
done
good "a higher score is asked for" recognize --models parts --min-score 1 --json "$frame"
grep -q '"model_name":null.*below 1"' out.txt || fail "recognize --min-score: $(head -c 300 out.txt)"
bad "a score beyond 1" "must be 0 to 1" recognize --models parts --min-score 2 "$frame"
bad "a kind that no scene has" "its kinds are" captured "$root/scenes" --models "$root/parts" --kind instanc
bad "unknown recognizer" "magic" recognize --models parts --recognizer magic "$frame"
bad "recognizer and configuration" "exclude" recognize --dataset dataset --config clouds.json --recognizer engine s.pcd
bad "lines twice" "give one of them" recognize --models parts --json --jsonl lines.jsonl "$frame"
"$partpose" recognize --models parts --jsonl - "$frame" >out.txt 2>err.txt
[ "$(wc -l <out.txt)" -eq 1 ] && grep -q '^{.*}$' out.txt || fail "text among the lines of --jsonl -: $(tail -n 1 out.txt)"
"$partpose" recognize --models parts "$frame" >out.txt 2>err.txt
grep -q 'bracket.png: bracket, score 0.[0-9]*.* ms)$' out.txt || fail "recognize, in words: $(cat out.txt)"

echo "-- JSON of the other commands"
good "dataset --json" dataset --models parts --config small.json --output small_again --json && grep -q '"views": 12' out.txt || fail "dataset --json: $(cat out.txt)"
good "index --json" index --dataset small_again --json && grep -q '"global_descriptor": "vfh"' out.txt || fail "index --json: $(cat out.txt)"
good "scenes --json" scenes --models parts --frames 1 --config scenes.json --output drawn_json --json && grep -q '"frames": 1' out.txt || fail "scenes --json: $(cat out.txt)"
good "resting poses --json" scenes --models parts --list-poses --json && grep -q '"table_from_model"' out.txt || fail "scenes --list-poses --json"
good "ambiguity --json" ambiguity parts/bracket.stl --camera "$root/scenes/bracket.camera.json" --subdivide 0 --json && grep -q '"pose_ambiguous"' out.txt || fail "ambiguity --json: $(cat out.txt)"
good "report --json" report iterations --json && grep -q '"frames"' out.txt || fail "report --json: $(cat out.txt)"
good "bop score --json" bop score "$golden" "$golden/$results" --image-width 640 --json && grep -q '"bop19_average_recall_mssd"' out.txt || fail "bop score --json: $(head -c 300 out.txt)"
good "experiment --json" experiment experiment.json -o experiment --json && grep -q '"correct"' out.txt || fail "experiment --json: $(head -c 300 out.txt)"
if command -v python3 >/dev/null; then
  for command in "dataset --models parts --config small.json --output small_again" "evaluate --dataset small --test small" "inspect parts" "symmetry parts" "report iterations" "view iterations/$(ls iterations | grep -v meshes | grep -v report | head -n 1) --no-open"; do
    good "$command --json" $command --json
    python3 -c 'import json, sys; json.load(sys.stdin)' <out.txt || fail "$command --json is not one JSON document: $(head -c 300 out.txt)"
  done
fi

echo "-- a page of one frame"
mkdir -p desktop
printf '#!/bin/sh\necho "$1" >"%s/opened.txt"\n' "$work" >desktop/xdg-open && chmod +x desktop/xdg-open
DISPLAY= WAYLAND_DISPLAY= good "view without a display" view --models parts "$frame"
[ "$(stat -c %s bracket.report.html)" -gt 500000 ] || fail "view: the page is too small"
grep -q '^bracket.report.html: open it' out.txt || fail "view says: $(cat out.txt)"
[ ! -e opened.txt ] || fail "view opened a page without a display"
PATH="$work/desktop:$PATH" DISPLAY=:7 good "view with a display" view --models parts --output seen.html "$frame"
[ "$(cat opened.txt)" = "$work/seen.html" ] || fail "view opened: $(cat opened.txt)"
rm opened.txt
PATH="$work/desktop:$PATH" DISPLAY=:7 good "view --no-open" view --models parts --no-open --json "$frame"
[ ! -e opened.txt ] || fail "view --no-open opened a page"
grep -q '"report": "bracket.report.html"' out.txt || fail "view --json: $(tail -c 300 out.txt)"
good "view by configuration" view --dataset dataset --config default_pipeline.json --no-open -o why.html dataset/models/0001/views/0007.pcd
[ -s why.html ] || fail "view wrote no page"
[ -z "$(ls -d "${TMPDIR:-/tmp}"/partpose-view-* 2>/dev/null)" ] || fail "view leaves a temporary folder"
bad "view of nothing" "nowhere.png" view --models parts nowhere.png
bad "view of many" "has no result.json" view evaluated
bad "view to nowhere" "cannot be written" view --models parts -o nowhere/page.html --no-open "$frame"

echo "-- terminals, logs and shells"
"$partpose" -v recognize --models parts "$frame" >out.txt 2>err.txt || fail "-v: exit code $?"
grep -q ' ms  ' err.txt && grep -q 'link.stl: link, ' err.txt || fail "-v says: $(cat err.txt)"
bad "quiet and verbose" "excludes" -v recognize --models parts "$frame"
coloured() { grep -q "$(printf '\033')\[" "$1"; }
"$partpose" recognize --models nowhere "$frame" >out.txt 2>err.txt
! coloured err.txt || fail "colours in a log"
if command -v script >/dev/null; then
  on_terminal() { checks=$((checks + 1)); script -qec "$*" /dev/null </dev/null >typescript.txt 2>&1; }
  export TERM=xterm
  on_terminal "$partpose" recognize --models nowhere "$frame"
  coloured typescript.txt || fail "no colours on a terminal"
  NO_COLOR=1 on_terminal "$partpose" inspect parts nowhere.stl
  ! grep -q "$(printf '\033')\[3" typescript.txt || fail "colours in spite of NO_COLOR"
  TERM=dumb on_terminal "$partpose" recognize --models nowhere "$frame"
  ! coloured typescript.txt || fail "colours on a dumb terminal"
  on_terminal "$partpose" dataset --models parts --config small.json --output small_again
  grep -q '\[==* *\] [0-9]*/' typescript.txt || fail "no progress bar on a terminal: $(head -c 300 typescript.txt)"
  for command in "report evaluated" "inspect parts" "sensor fit $root/scenes/empty_table.png --baseline 55 --region 200 240 300 200"; do
    on_terminal "$partpose" $command
    grep -q '\[=* *\] [0-9]*/' typescript.txt || fail "$command: no progress bar on a terminal: $(head -c 300 typescript.txt)"
    on_terminal "$partpose" -q $command
    ! grep -q '\[=' typescript.txt || fail "$command: a progress bar with --quiet"
  done
  on_terminal "$partpose" -q dataset --models parts --config small.json --output small_again
  ! grep -q '\[=' typescript.txt || fail "a progress bar with --quiet"
fi
for shell in bash zsh fish; do
  good "completion $shell" completion $shell
  cp out.txt completion.$shell
  for word in recognize experiment --models --chord-tolerance; do grep -q -- "${word#--}" completion.$shell || fail "completion $shell: no $word"; done
  if command -v $shell >/dev/null; then $shell -n completion.$shell || fail "completion $shell: not valid"; fi
done
complete_as() { # complete_as EXPECTED WORD...: what bash offers for the last word
  local expected=$1
  shift
  checks=$((checks + 1))
  (
    source completion.bash
    compopt() { :; }
    COMP_WORDS=("$partpose" "$@") COMP_CWORD=$#
    _partpose
    printf '%s\n' "${COMPREPLY[@]}"
  ) >out.txt 2>err.txt
  grep -qx -- "$expected" out.txt || fail "completion of '$*': '$expected' is not in: $(tr '\n' ' ' <out.txt | head -c 300) $(cat err.txt)"
}
complete_as recognize reco
complete_as score bop sc
complete_as live li
complete_as --follow live --fo
complete_as --models recognize --mo
complete_as --threads recognize --th
complete_as engine recognize --recognizer en
complete_as zsh completion z
complete_as dataset config da
complete_as vfh.k_nn= recognize --set vfh.k
complete_as virtual_views_icosahedron.subdivide= dataset -s virtual_views
complete_as preprocessing.voxel_size config --explain preprocessing.vox
complete_as small.json dataset --config sma
bad "completion of another shell" "tcsh" completion tcsh

echo "-- interrupted"
# interrupted NAME SIGNAL EXIT_CODE GLOB COMMAND...: the signal comes as soon as GLOB matches something
interrupted() {
  checks=$((checks + 1))
  python3 - "$partpose" "$@" <<'PYTHON' || fail "interrupted $1: $(cat err.txt)"
import glob, signal, subprocess, sys, time
program, name, number, code, pattern, *command = sys.argv[1:]
with open("err.txt", "w") as err:
    process = subprocess.Popen([program, "-q", *command], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
                               preexec_fn=lambda: [signal.signal(s, signal.SIG_DFL) for s in (signal.SIGINT, signal.SIGTERM)])
    until = time.time() + 60
    while not glob.glob(pattern) and process.poll() is None and time.time() < until:
        time.sleep(0.002)
    process.send_signal(getattr(signal, number))
    said = process.communicate(timeout=60)[1]
    if process.returncode != int(code):
        err.write(f"exit code {process.returncode} instead of {code}: {said}")
        sys.exit(1)
    if said not in ("", "partpose: interrupted\n"):
        err.write("said " + said)
        sys.exit(1)
PYTHON
}
if command -v python3 >/dev/null; then
  many_views="--set virtual_views_icosahedron.subdivide=3"
  interrupted "dataset" SIGINT 130 'cut.partial-*' dataset --models parts $many_views --output cut
  interrupted "dataset's views" SIGTERM 143 'cut.partial-*/models/0000/views/*' dataset --models parts $many_views --output cut
  interrupted "scenes" SIGINT 130 'cut.partial-*/test/000001/depth/*' scenes --models parts --frames 1000 --output cut
  interrupted "catalogue" SIGINT 130 'cut_cache/*.partial-*' recognize --recognizer recognizer --models parts --cache cut_cache "$frame"
  [ -z "$(ls -d cut* | grep -v '^cut_cache$')" ] && [ -z "$(ls -A cut_cache)" ] || fail "left behind: $(ls -d cut* cut_cache/*)"
  cp small/dataset.json before.json
  interrupted "dataset in an older one's place" SIGINT 130 'small.partial-*/models/0000/views/*' dataset --models parts $many_views --output small
  cmp -s small/dataset.json before.json || fail "the older dataset is lost"
  frames=() && for i in $(seq 300); do frames+=("$frame"); done
  interrupted "recognize" SIGINT 130 'cut_frames/2*/result.json' recognize --models parts --output cut_frames --jsonl cut.jsonl "${frames[@]}"
  [ "$(ls -d cut_frames/2* | wc -l)" -eq "$(ls cut_frames/2*/result.json | wc -l)" ] || fail "a half-written iteration folder"
  [ "$(wc -l <cut.jsonl)" -eq "$(grep -c '}$' cut.jsonl)" ] && [ "$(wc -l <cut.jsonl)" -lt 300 ] || fail "recognize: $(wc -l <cut.jsonl) lines, $(grep -c '}$' cut.jsonl) of them whole"
  interrupted "evaluate" SIGINT 130 'cut_evaluated/2*/result.json' evaluate --dataset dataset --test dataset --output cut_evaluated
  [ "$(ls -d cut_evaluated/2* | wc -l)" -eq "$(ls cut_evaluated/2*/evaluation_dataset.json | wc -l)" ] || fail "a half-written iteration folder"
  for ms in 020 040 060 080 100 120 140 160 180 200 220 240 260 280 300; do
    timeout -s INT 0.$ms "$partpose" -q report evaluated >/dev/null 2>&1
    code=$?
    [ $code -eq 0 ] || [ $code -eq 124 ] || fail "report interrupted after 0.$ms s: exit code $code"
  done
  [ -z "$(ls -A evaluated | grep tmp)" ] || fail "report interrupted: left behind $(ls -A evaluated | grep tmp)"
  good "the report is whole" report evaluated
  rm -rf experiment
  interrupted "experiment" SIGINT 130 'experiment/frames.jsonl' experiment experiment.json -o experiment
  good "experiment goes on" experiment experiment.json -o experiment
  [ "$(grep -c '}$' experiment/frames.jsonl)" -eq 24 ] || fail "experiment: $(grep -c '}$' experiment/frames.jsonl) frames instead of 24"
  rm -f live.jsonl frames/aa.png
  mkdir no_frames
  interrupted "live, before the first frame" SIGINT 130 'no_frames.jsonl' live no_frames --follow --models parts --jsonl no_frames.jsonl
  interrupted "live, which it is meant to end" SIGINT 0 'live.jsonl' live frames --follow --models parts --jsonl live.jsonl
fi

echo "-- bad usage"
bad "no command" "subcommand" 
bad "unknown command" 'there is no command recognise; did you mean recognize? (see partpose --help)' recognise --models parts "$frame"
bad "unknown command of bop" 'there is no command scores; did you mean score? (see partpose bop --help)' bop scores toy
bad "unknown option" 'there is no option --modles; did you mean --models? (see partpose recognize --help)' recognize --modles parts "$frame"
bad "an option like no other" 'there is no option --xyzzyqqqq (see partpose --help)' --xyzzyqqqq
bad "unknown option of all" 'did you mean --version' --versoin
bad "what is missing" 'scenes is required (see partpose recognize --help)' recognize --models parts
bad "no scenes" "scenes" recognize --models parts
bad "neither parts nor dataset" "--models" recognize "$frame"

echo "-- a full disk behind standard output"
for arguments in "recognize --models parts $frame" "recognize --models parts --json $frame" "inspect parts" "config"; do
  checks=$((checks + 1))
  # shellcheck disable=SC2086
  "$partpose" $arguments >/dev/full 2>err.txt </dev/null
  code=$?
  [ $code -eq 2 ] || fail "$arguments: exit code $code instead of 2 when its output is lost: $(cat err.txt)"
  ! grep -q "a fault of partpose" err.txt || fail "$arguments: $(cat err.txt)"
done

echo "$checks checks, $failures failed"
[ $failures -eq 0 ]
