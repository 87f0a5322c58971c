# The commands of the README. Each installs what is missing (Debian), configures, builds and runs; a second run takes seconds.
#
#   make demo            build/release/bin/carom, then out/demo/{report.json,picture.png,frames.pvd}
#   make test            the whole test-suite
#   make demo VIZ=OFF    the same without VTK: not installed, not built; no picture and no frames
#
# demo, test, bench and peers share build/release, so what one has built the others need not build again.
VIZ ?= ON
# Warnings stop the build with the compiler of Debian 12; another compiler may know more of them.
WERROR ?= $(if $(filter 12 12.%,$(shell c++ -dumpversion)),ON,OFF)
JOBS ?= $(shell nproc)

# Not `:=`: these look at what the target `setup` may just have installed.
PACKAGES = base tests $(if $(filter ON,$(VIZ)),viz)
CONFIGURE = -DCAROM_VIZ=$(VIZ) -DCAROM_WERROR=$(WERROR) \
            $(if $(shell command -v ccache),-DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
PICTURES = $(if $(filter ON,$(VIZ)),--picture out/demo/picture.png --vtk out/demo)
SOURCES = $(wildcard core collision broadphase narrowphase dynamics viz scenes studies cli bench tests examples)

.PHONY: demo test asan tsan fuzz bench peers format tidy clean setup
.DEFAULT_GOAL := demo

demo: setup
	@cmake --preset release $(CONFIGURE)
	@cmake --build --preset release --target carom -j $(JOBS)
	@mkdir -p out/demo
	@tools/with_display.sh build/release/bin/carom run teapot_meshes --json out/demo/report.json $(PICTURES)

test: setup
	@cmake --preset release $(CONFIGURE)
	@cmake --build --preset release --target all all_verify_interface_header_sets -j $(JOBS)
	@tools/with_display.sh ctest --preset release -j $(JOBS)

# The test-suite under AddressSanitizer with UndefinedBehaviorSanitizer, and under ThreadSanitizer.
asan: SANITIZED = asan-ubsan
tsan: SANITIZED = tsan
asan tsan: setup
	@cmake --preset $(SANITIZED) $(CONFIGURE) -DCAROM_WERROR=OFF
	@cmake --build --preset $(SANITIZED) -j $(JOBS)
	@tools/with_display.sh ctest --preset $(SANITIZED) -j $(JOBS)

# Each fuzzer for FUZZ_SECONDS, from the inputs in tests/fuzz/corpus. What it finds to be new stays in out/fuzz/<name>; an input that
# breaks something is named there too, and is the argument to run the program with again.
FUZZ_SECONDS ?= 60
fuzz: PACKAGES = base fuzz
fuzz: setup
	@cmake --preset fuzz $(filter -DCMAKE_CXX_COMPILER_LAUNCHER=%,$(CONFIGURE))
	@cmake --build --preset fuzz --target fuzzers -j $(JOBS)
	@set -e; for source in tests/fuzz/*_fuzz.cpp; do \
	    program=$$(basename $$source .cpp); name=$${program%_fuzz}; mkdir -p out/fuzz/$$name; \
	    case $$name in *_file) bytes=8192 ;; *) bytes=512 ;; esac; `# a saved tree has 872 at least` \
	    echo "$$program for $(FUZZ_SECONDS) s"; \
	    build/fuzz/bin/$$program -max_total_time=$(FUZZ_SECONDS) -max_len=$$bytes -print_final_stats=1 -verbosity=0 \
	        -artifact_prefix=out/fuzz/$$name- out/fuzz/$$name $$(ls -d tests/fuzz/corpus/$$name 2>/dev/null); \
	done

bench: PACKAGES += bench
bench: setup
	@cmake --preset release $(CONFIGURE) -DCAROM_BENCH=ON
	@cmake --build --preset release --target bench_step bench_pairs bench_primitives bench_sweeps -j $(JOBS)
	@echo "Built build/release/bin/bench_step, bench_pairs, bench_primitives and bench_sweeps, Google Benchmark programs"

peers: PACKAGES += peers
peers: setup
	@cmake --preset release $(CONFIGURE) -DCAROM_PEERS=ON
	@cmake --build --preset release --target peers -j $(JOBS)
	@echo "Built build/release/bin/peers; for example: build/release/bin/peers step"

format: PACKAGES = format
format: setup
	@find $(SOURCES) \( -name '*.hpp' -o -name '*.cpp' \) -print0 | xargs -0 clang-format-14 -i

tidy: PACKAGES += tidy
tidy: setup
	@cmake --preset tidy -DCAROM_VIZ=$(VIZ)
	@cmake --build --preset tidy -j $(JOBS)

clean:
	rm -rf build out

setup:
	@tools/setup.sh $(PACKAGES)
