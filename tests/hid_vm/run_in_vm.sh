#!/usr/bin/env bash
# run_in_vm.sh: boots a Debian kernel under QEMU with the HID tests and voxrun in its initramfs, and
# gives the tests' status. The kernel's package is downloaded once, into build/hid_vm. Status 77:
# skipped, because something cannot be had.
set -euo pipefail
bin=$FORCELAYER_BIN_DIR
cache=$FORCELAYER_SOURCE_DIR/build/hid_vm
modules=(hid uhid hid-generic)

source "$FORCELAYER_SOURCE_DIR/tests/support/skipped.sh"

[ "$(uname -m)" = x86_64 ] || skip "they need an x86-64 kernel"
for tool in qemu-system-x86_64 busybox cpio apt-get dpkg; do
  command -v "$tool" >/dev/null || skip "needs $tool of scripts/packages.txt"
done

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# The kernel that the package linux-image-cloud-amd64 stands for, and three of its modules.
fetch_kernel() {
  local package tree=$scratch/kernel
  package=$(apt-cache depends linux-image-cloud-amd64 2>/dev/null |
    sed -n 's/.*Depends: \(linux-image-[0-9].*\)/\1/p' | head -n 1)
  [ -n "$package" ] || skip "apt does not know linux-image-cloud-amd64 (apt-get update?)"
  mkdir -p "$scratch/download" "$tree" "$scratch/ready"
  (cd "$scratch/download" && apt-get -q download "$package" >apt.log 2>&1) ||
    skip "the kernel's package $package cannot be downloaded"
  dpkg -x "$scratch"/download/*.deb "$tree"
  cp "$tree"/boot/vmlinuz-* "$scratch/ready/vmlinuz"
  for module in "${modules[@]}"; do
    find "$tree" -name "$module.ko" -exec cp {} "$scratch/ready/" \;
    [ -s "$scratch/ready/$module.ko" ] || skip "$package has no $module.ko"
  done
  mkdir -p "$(dirname "$cache")"
  rm -rf "$cache"
  mv "$scratch/ready" "$cache"
}
[ -s "$cache/vmlinuz" ] || fetch_kernel

# Everything that the programs load, at the same paths as here.
root=$scratch/root
mkdir -p "$root"/{bin,dev,proc,sys,tmp,lib/modules}
cp "$(command -v busybox)" "$root/bin/busybox"
for name in sh mount insmod sleep poweroff; do ln -s busybox "$root/bin/$name"; done
programs=("$bin/hid_vm_tests" "$bin/voxrun" "$bin/make_runtime_files")
cp "${programs[@]}" "$root/bin/"
ldd "${programs[@]}" | sed -n 's/.*=> \(\/[^ ]*\).*/\1/p; s/^[[:space:]]*\(\/[^ ]*ld-linux[^ ]*\).*/\1/p' |
  sort -u | while read -r library; do
  mkdir -p "$root$(dirname "$library")"
  cp -L "$library" "$root$library"
done
for module in "${modules[@]}"; do cp "$cache/$module.ko" "$root/lib/modules/"; done
cat >"$root/init" <<'INIT'
#!/bin/sh
mount -t devtmpfs none /dev
mount -t proc none /proc
mount -t sysfs none /sys
mount -t tmpfs none /tmp
for module in hid uhid hid-generic; do insmod /lib/modules/$module.ko; done
cd /tmp
/bin/make_runtime_files /tmp && /bin/hid_vm_tests --gtest_color=no
echo "HID_VM_STATUS $?"
poweroff -f
INIT
chmod +x "$root/init"
(cd "$root" && find . | cpio -o -H newc --quiet | gzip -1) >"$scratch/initramfs.gz"

# Two nanoseconds an instruction, and no waiting while it is idle: the machine's time is that of its
# own work, so that a busy host makes nothing in it late.
timeout -k 5 "${HID_VM_TIMEOUT_S:-500}" qemu-system-x86_64 -accel tcg -icount shift=1,sleep=off \
  -nographic -no-reboot -nic none -m 256 -smp 1 \
  -kernel "$cache/vmlinuz" -initrd "$scratch/initramfs.gz" \
  -append 'console=ttyS0 panic=-1 quiet' </dev/null >"$scratch/serial.log" 2>&1 || true

tr -d '\r' <"$scratch/serial.log" >"$scratch/log"
cat "$scratch/log"
grep -q '^HID_VM_STATUS 0$' "$scratch/log"
