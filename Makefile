# Front door. Everything runs in .venv, which the first target that needs it sets up. Targets that need an OpenCL device
# look every time whether one still works, as a driver may go where .venv stays.
PYTHON ?= python3
BIN := .venv/bin
READY := .venv/.ready

.DEFAULT_GOAL := help
.PHONY: help demo test test-all lint gpu-static bench gpu docs site package clean device implementations gpu-compilers

help:  ## list the targets
	@sed -n 's/^\([a-z-]*\):.*## /\1	/p' $(MAKEFILE_LIST) | expand -t 12

demo: device  ## render a built-in scene with noise and denoise it
	$(BIN)/svgf-cl demo

test: device  ## run the tests
	$(BIN)/python -m pytest -n auto --maxprocesses 8 --dist worksteal

test-all: implementations  ## run the tests on PoCL, Intel's runtime, rusticl, Oclgrind and every GPU; show each kernel's error
	$(BIN)/python -m scripts.test_all

lint: $(READY)  ## check style, types, who imports whom, and kernels (needs clang)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/python -m scripts.lint_kernels

gpu-static: gpu-compilers  ## compile every kernel for GPUs, without one; fail on spills, scratch memory, too many registers
	$(BIN)/python -m benchmarks.gpu_static -o out/gpu_static

# Intel's runtime as a second device, and a rival: 350 MB in all, and the report does without what cannot be had.
bench: device  ## time every kernel on every device, beside rival and error; report in out/bench (ten minutes)
	-$(BIN)/pip install --quiet --disable-pip-version-check --editable '.[dev,cpu,oidn]'
	$(BIN)/python -m benchmarks --output out/bench

# Installs nothing but the environment: where that is ready, no network is needed.
gpu: $(READY)  ## test, tune and time a GPU in under ten minutes; report in out/gpu, see docs/gpu.md
	$(BIN)/python -m benchmarks.gpu -o out/gpu

docs: demo implementations  ## make docs/accuracy.md, docs/scene_description.md, docs/settings.md, the tables of docs/algorithm.md and docs/gpu.md and all pictures again
	$(BIN)/python -m benchmarks.accuracy_page docs/accuracy.md
	$(BIN)/python scripts/picture.py
	$(BIN)/python -m scripts.view_picture
	$(BIN)/python scripts/scene_description.py
	$(BIN)/python scripts/settings_page.py
	$(BIN)/python scripts/pass_table.py
	$(BIN)/python -m benchmarks.gpu.roofline docs/gpu.md
	$(BIN)/svgf-cl scenes -o docs/builtin_scenes.webp --size 320x180 --spp 128

site: $(READY)  ## build the documentation site in out/site; any warning fails
	$(BIN)/pip install --quiet --disable-pip-version-check 'svgf-cl[docs]'
	$(BIN)/python -m scripts.site

package: device  ## build the wheel and the source archive in out/package, and check that they are whole and work
	$(BIN)/pip install --quiet --disable-pip-version-check 'svgf-cl[release]'
	$(BIN)/python -m scripts.check_package -o out/package

clean:  ## remove what the other targets made
	rm -rf .venv build *.egg-info .*_cache

device: $(READY)
	@scripts/set_up device

implementations: $(READY)
	@scripts/set_up implementations

gpu-compilers: $(READY)
	@scripts/set_up gpu-compilers

$(READY): pyproject.toml setup.py scripts/set_up
	@PYTHON=$(PYTHON) scripts/set_up environment
	@touch $@
