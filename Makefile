# Everyday commands; the work is done by the scripts in tools/. `make help` lists them.
SCENE ?=
FRAMES ?=
OUT ?= out
ARGS ?=
COMPONENTS ?=
BLENDER ?=

.DEFAULT_GOAL := help
.PHONY: help build render render-animation test test-full test-native test-addon stress faults compilers package schema format lint clean
.PHONY: bench bench-errors bench-compare bench-agreement bench-animation bench-motion bench-quick bench-speed bench-designs bench-suite bench-pictures bench-host bench-report picture picture-components

help:           ## this list
	@sed -n 's/^\([a-z-]*:\)  *## /  make \1 /p' Makefile

build:          ## the library (into addon/gradus/lib) and the tool
	@tools/build.sh

render:         ## a picture: SCENE=sample_blends/hero.blend FRAMES=1-24 OUT=dir ARGS="--gradus-samples 32" COMPONENTS=default BLENDER=/path/to/blender
	@SCENE='$(SCENE)' FRAMES='$(FRAMES)' OUT='$(OUT)' ARGS='$(ARGS)' COMPONENTS='$(COMPONENTS)' BLENDER='$(BLENDER)' tools/render.sh

render-animation: ## frames by blender -b -a, and a film strip: SCENE=sample_blends/animated.blend FRAMES=1-24 OUT=dir ARGS="--gradus-samples 16"
	@SCENE='$(or $(SCENE),sample_blends/animated.blend)' FRAMES='$(or $(FRAMES),1-24)' OUT='$(OUT)' ARGS='$(or $(ARGS),--gradus-samples 16)' \
	 BLENDER='$(BLENDER)' tools/render.sh --animation

test:           ## all tests that every change must pass; last line: N passed, N failed
	@tools/test.sh all

test-full:      ## and those that take longer, and everything in all hosts
	@tools/test.sh --full all

test-native:    ## only the tests of the library
	@tools/test.sh native

test-addon:     ## only those of the add-on; with HOSTS=bpy45,bpy52 all of them in these hosts: TESTS=tests/addon/x_test.py
	@tools/test.sh addon

stress:         ## numerical stability: hard scenes, their dropped samples and failed shifts as a table
	@tools/test.sh stress

faults:         ## faults put into a copy of the sources, one at a time: do the tests catch them? docs/faults.md; half an hour
	@tools/setup/setup test
	@/usr/bin/python3 tests/faults/faults.py

compilers:      ## statistics of a build without optimisation, and of one by clang; half an hour
	@tools/compilers.sh

bench:          ## everything below, all scenes; interrupted runs go on: SCENES=a,b MODES=path,auto WIDTH=160 REFERENCE=1024 MINUTES=60
	@SCENES='$(SCENES)' MODES='$(MODES)' WIDTH='$(WIDTH)' REFERENCE='$(REFERENCE)' SEEDS='$(SEEDS)' SAMPLES='$(SAMPLES)' MINUTES='$(MINUTES)' \
	 tools/bench.sh

bench-errors:   ## error against CPU time alone; limited by the same variables
	@SCENES='$(SCENES)' MODES='$(MODES)' WIDTH='$(WIDTH)' REFERENCE='$(REFERENCE)' SEEDS='$(SEEDS)' SAMPLES='$(SAMPLES)' MINUTES='$(MINUTES)' \
	 tools/bench.sh --errors

bench-agreement: ## converged images against those of Cycles and Mitsuba; limited by the same variables
	@SCENES='$(SCENES)' WIDTH='$(WIDTH)' REFERENCE='$(REFERENCE)' tools/bench.sh --agreement

bench-animation: ## flicker of animations against CPU time; limited by the same variables, varied by SIZE=320x180 FRAMES=24 BLUR=1
	@SCENES='$(SCENES)' MODES='$(MODES)' REFERENCE='$(REFERENCE)' SEEDS='$(SEEDS)' SAMPLES='$(SAMPLES)' MINUTES='$(MINUTES)' \
	 SIZE='$(SIZE)' FRAMES='$(FRAMES)' BLUR='$(BLUR)' tools/bench.sh --animation

bench-motion:   ## motion of reflections and refractions, and what it is worth; as bench-animation, PARTS=truth,prediction,flicker,cost REPEATS=3 LOADED=1
	@SCENES='$(SCENES)' MODES='$(MODES)' REFERENCE='$(REFERENCE)' SEEDS='$(SEEDS)' SAMPLES='$(SAMPLES)' MINUTES='$(MINUTES)' \
	 SIZE='$(SIZE)' FRAMES='$(FRAMES)' BLUR='$(BLUR)' PARTS='$(PARTS)' REPEATS='$(REPEATS)' LOADED='$(LOADED)' tools/bench.sh --motion

bench-quick:    ## errors of two scenes, in under five minutes
	@tools/bench.sh --quick

bench-compare:  ## two versions among the stored results, error and rays of L2 and WEIGHTED: OLD=772811d NEW=414ff4f WIDTH=160
	@OLD='$(OLD)' NEW='$(NEW)' WIDTH='$(WIDTH)' tools/bench.sh --compare

bench-speed:    ## CPU time of a sample in a room of 1 k to 2 M triangles, against Cycles: ROOMS=room-1k SPEED_WIDTH=640 REPEATS=3
	@ROOMS='$(ROOMS)' SPEED_WIDTH='$(SPEED_WIDTH)' REPEATS='$(REPEATS)' tools/bench.sh --speed

bench-designs:  ## the product's reconstructions against published ones: SCENES=hero,kitchen REFERENCE=1024
	@SCENES='$(SCENES)' REFERENCE='$(REFERENCE)' tools/bench.sh --designs

bench-suite:    ## time of the statistical tests, and of the reconstructions at 1920x1080
	@tools/bench.sh --suite

bench-pictures: ## pictures of the project's own scenes by all modes: SCENES=hero
	@SCENES='$(SCENES)' tools/bench.sh --pictures

bench-host:     ## export and upload in each Blender, half a minute
	@tools/bench.sh --host

bench-report:   ## docs/benchmark/report.html and README.md from the stored results alone
	@tools/bench.sh --report

picture:        ## docs/images/hero.png, the picture of the README
	@SCENE=sample_blends/hero.blend FRAMES=1 OUT=out/picture ARGS='--gradus-samples 64' BLENDER='$(BLENDER)' tools/render.sh
	@install -D -m 644 out/picture/hero_0001.png docs/images/hero.png

picture-components: ## docs/images/components.webp, a frame taken apart, of the user guide
	@tools/setup/setup bpy
	@SCENE=sample_blends/components.blend FRAMES=12 OUT=out/picture ARGS='--gradus-samples 128' COMPONENTS=default BLENDER='$(BLENDER)' tools/render.sh
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
