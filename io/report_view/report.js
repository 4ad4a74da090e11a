// SPDX-License-Identifier: MIT
document.documentElement.dataset.battenReady = "0";
