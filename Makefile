# Everyday commands; the work is done by the scripts in tools/. `make help` lists them.
SCENE ?=
FRAMES ?=
OUT ?= out
ARGS ?=
COMPONENTS ?=
BLENDER ?=
# Recipes read these from the environment, because the shell would interpret quotes in their text.
ifneq ($(filter render render-animation picture picture-components,$(MAKECMDGOALS)),)
export SCENE FRAMES OUT ARGS COMPONENTS BLENDER
endif

.DEFAULT_GOAL := help
.PHONY: help build render render-animation test test-full test-native test-regression test-addon stress faults coverage compilers package schema format lint clean
BENCH := $(addprefix bench-,errors quick agreement pictures speed rooms paths profiles reconstruct animation motion \
           host designs animated-designs compare report)
.PHONY: bench $(BENCH) picture picture-components

help:           ## this list
	@sed -n 's/^\([a-z-]*:\)  *## /  make \1 /p' Makefile

build:          ## the library (into addon/gradus/lib) and the tool
	@tools/build.sh

render:         ## a picture: SCENE=sample_blends/hero.blend FRAMES=1-24 OUT=dir ARGS="--gradus-samples 32" COMPONENTS=default BLENDER=/path/to/blender
	@tools/render.sh

render-animation: ## frames by blender -b -a, and a film strip: SCENE=sample_blends/animated.blend FRAMES=1-24 OUT=dir ARGS="--gradus-samples 16"
	@SCENE="$${SCENE:-sample_blends/animated.blend}" FRAMES="$${FRAMES:-1-24}" ARGS="$${ARGS:---gradus-samples 16}" \
	 tools/render.sh --animation

test:           ## all tests that every change must pass; last line: N passed, N failed
	@tools/test.sh all

test-full:      ## and those that take longer, and everything in all hosts
	@tools/test.sh --full all

test-native:    ## only the tests of the library
	@tools/test.sh native

test-regression: ## only the stored pictures: a render of each must have their bits, or look like them on other machines
	@tools/test.sh regression

test-addon:     ## only those of the add-on and the tools; with HOSTS=bpy45,bpy52 all of them in these hosts: TESTS=tests/addon/x_test.py
	@tools/test.sh addon

stress:         ## numerical stability: hard scenes, their dropped samples and failed shifts as a table
	@tools/test.sh stress

faults:         ## faults switched on in a test build, one at a time: do the tests catch them? docs/faults.md; ten minutes, after a build
	@tools/setup/setup test
	@/usr/bin/python3 tests/faults/faults.py

coverage:       ## features next to Cycles, into docs/coverage.md: HOSTS=bpy45 ROWS='ShaderNodeMath*' AGAIN=1; ten minutes a host
	@tools/coverage.sh

compilers:      ## statistics of a build without optimisation, and of one by clang; half an hour
	@tools/compilers.sh

# Results, pictures and the report go to out/bench. Variables limit a part: the head of tools/bench.sh lists them.
bench:          ## all parts but quick, the designs and compare, each for MINUTES=60 at most; a further call goes on
	@tools/bench.sh all

bench-errors:   ## stills: error against CPU time next to Cycles and Mitsuba: SCENES=a,b MODES=path,auto WIDTH=160
bench-quick:    ## the same for two scenes, in under five minutes
bench-agreement: ## stills: converged images against those of Cycles and Mitsuba: SCENES=a,b WIDTH=160 REFERENCE=1024
bench-pictures: ## stills: pictures and error maps of the project's own scenes: SCENES=hero
bench-speed:    ## the next four and the errors of the main modes, for the table of targets in the report
bench-rooms:    ## CPU time of a sample and of start-up, rooms of 1 k to 2 M triangles: ROOMS=room-1k REPEATS=3
bench-paths:    ## variance and CPU time of a sample in scenes next to Cycles: SCENES=a,b SPEED_WIDTH=640
bench-profiles: ## where the time of plain paths goes: flame graphs, and the share of ray tracing: SCENES=a,b
bench-reconstruct: ## CPU time of the reconstructions at 1920x1080: REPEATS=3
bench-animation: ## animations: error and flicker against CPU time: SCENES=a,b BLUR=1 QUICK=1 (two, 30 minutes)
bench-motion:   ## motion of components: MEASURES=truth,prediction,flicker,cost SCENES=a,b BLUR=1 LOADED=1
bench-host:     ## export and upload in each Blender, half a minute
bench-designs:  ## the reconstructions next to published ones: SCENES=hero,kitchen WIDTH=160 REFERENCE=1024
bench-animated-designs: ## SVGF and NFOR: NAME=kitchen STORES=a,b REFERENCES=a,b FRAMES=12-14 CROP=60,60,160,90
bench-compare:  ## two commits whose stills were measured: OLD=772811d NEW=414ff4f WIDTH=160
bench-report:   ## out/bench/report.html and report.md from the results in out/bench
$(BENCH): bench-%:
	@tools/bench.sh $*

picture:        ## docs/images/hero.png, the picture of the README
	@SCENE=sample_blends/hero.blend FRAMES=1 OUT=out/picture ARGS='--gradus-samples 64' tools/render.sh
	@install -D -m 644 out/picture/hero_0001.png docs/images/hero.png

picture-components: ## docs/images/components.webp, a frame taken apart, of the user guide
	@tools/setup/setup bpy
	@SCENE=sample_blends/components.blend FRAMES=12 OUT=out/picture ARGS='--gradus-samples 128' COMPONENTS=default tools/render.sh
	@.venv/bpy45/bin/python3 tools/component_sheet.py out/picture/components_0012.exr docs/images/components.webp

package:        ## dist/gradus-<version>.zip, for Blender 3.4 to 5.2
	@tools/build.sh package

schema:         ## what schema/*.toml determine: headers, tables of the library and of the add-on, tables of the user guide
	@/usr/bin/python3 tools/schema/generate.py

format:         ## clang-format and ruff format
	@tools/lint.sh format

lint:           ## clang-format, clang-tidy and ruff, without changing anything
	@tools/lint.sh check

clean:          ## what was built here; environments and the cache stay
	@rm -rf build build-* dist addon/gradus/lib
