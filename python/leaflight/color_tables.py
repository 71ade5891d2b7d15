# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of color maps, which scripts/color_maps writes from the package cmap 0.8.

Sources and licenses:
Matplotlib has viridis, magma, inferno, plasma (CC0), cividis (BSD) and turbo (Apache 2.0). It also
has coolwarm, twilight (PSF) and bone.
Kovesi made the maps of CET (CC BY 4.0).
Crameri made batlow, lajolla, oslo, vik, berlin, roma and romaO (MIT).
The categorical maps are those of Tableau, and of Okabe and Ito.
"""

# Key -> evenly spaced sRGB colors.
TABLES: dict[str, str] = {
    "VIRIDIS": (
        "440154 470d60 48186a 482374 472d7b 453781 424086 3e4989 3b528b 375b8d 33638d 2f6b8e "
        "2c728e 297a8e 26828e 23898e 21918c 1f988b 1fa088 22a785 28ae80 32b67a 3fbc73 4ec36b "
        "5ec962 70cf57 84d44b 98d83e addc30 c2df23 d8e219 ece51b fde725 "
    ),
    "MAGMA": (
        "000004 030312 0a0822 130d34 1d1147 29115a 36106b 440f76 51127c 5d177f 6a1c81 762181 "
        "832681 902a81 9c2e7f aa337d b73779 c43c75 d0416f dc4869 e75263 ef5d5e f56b5c f9795d "
        "fc8961 fd9869 fea772 feb67c fec488 fed395 fde2a3 fcf0b2 fcfdbf "
    ),
    "BONE_MAP": (
        "000000 07070a 0e0e13 15151d 1c1c27 232331 2a2a3a 313144 38384e 3f3f58 464661 4d4d6b "
        "545574 5b5f7b 626882 697289 707b90 778597 7e8f9e 8598a5 8ca2ac 93acb3 9ab5ba a1bfc1 "
        "a9c8c8 b4cfcf bfd6d6 cadddd d5e4e4 e0ebeb eaf2f2 f5f9f9 ffffff "
    ),
    "CET_L3": (
        "000000 220000 320000 3f0000 4b0100 570100 630100 700200 7e0200 8b0300 990400 a60500 "
        "b50600 c30800 d10a00 e00d00 ed1500 f72900 fc4100 fe5600 ff6900 ff7a00 ff8a00 ff9900 "
        "ffa701 ffb402 ffc104 ffce06 ffdb0a ffe70f fff324 fffd84 ffffff "
    ),
    "CET_R2": (
        "0034f5 0048df 0059c9 0067b2 00739d 1c7c89 318476 3b8c63 3f944e 3f9d35 42a51b 55ab0f "
        "6aaf12 7eb415 91b919 a3bd1d b5c120 c6c524 d7c927 e8cd2b f6cc2c fcc429 fdba25 feaf21 "
        "ffa31c ff9818 ff8c13 ff800e ff730a ff6505 fe5602 fe4400 fd3000 "
    ),
    "CET_D1": (
        "2151db 3e59dd 5263de 626ce0 7075e2 7d7fe3 8a88e5 9592e6 a09ce8 aba6e9 b5b1ea c0bbeb "
        "cac5ed d3d0ee dddaef e6e4ee eee7e9 f1e1dd f2d5ce f1c9bf f0bdb0 efb0a1 eda492 ea9783 "
        "e78b75 e37e67 df7159 db644b d6563e d14730 cb3722 c52314 c00206 "
    ),
    "INFERNO": (
        "000004 040312 0b0724 150b37 210c4a 2f0a5b 3d0965 4a0c6b 57106e 64156e 71196e 7d1e6d "
        "8a226a 972766 a32c61 b0315b bc3754 c73e4c d24644 db503b e45a31 eb6628 f1731d f68013 "
        "f98e09 fb9d07 fcac11 fbbc21 f9cb35 f5db4c f2ea69 f3f68a fcffa4 "
    ),
    "PLASMA": (
        "0d0887 220690 310597 3f049c 4c02a1 5901a5 6600a7 7201a8 7e03a8 8a09a5 9511a1 a01a9c "
        "aa2395 b32c8e bc3587 c43e7f cc4778 d35171 da5a6a e06363 e66c5c eb7655 f0804e f58b47 "
        "f89540 fba139 fdac33 feb82c fdc527 fcd225 f8df25 f4ed27 f0f921 "
    ),
    "CIVIDIS": (
        "00224e 00285b 002e6a 053371 1a386f 273e6e 32436d 3b496c 434e6c 4b546c 535a6d 5a5f6e "
        "61656f 686a71 6f7073 767676 7d7c78 848279 8c8878 938e78 9b9476 a39a74 aba072 b4a76f "
        "bcae6c c4b468 cdbb63 d5c25e dec958 e7d150 f0d846 f9e03a fee838 "
    ),
    "BATLOW": (
        "011959 08255b 0d315d 0f3b5f 114360 134b61 175262 1b5962 226061 2b655e 356a59 416f53 "
        "4d734d 5a7745 677b3e 747e38 828231 91862d a18a2b b18d2f c09036 cf9340 dd954d e9995c "
        "f29d6d f9a380 fca993 fdafa5 fdb4b6 fdbac7 fcc0d8 fbc6ea faccfa "
    ),
    "LAJOLLA": (
        "191900 201c04 271e08 2f210d 372411 412716 4d2b1c 592f22 67342a 763931 853e39 96423f "
        "a64644 b74a48 c54f4a d1564c d9604e de6b4f e17550 e37f50 e58851 e79252 e99b52 eba453 "
        "edae54 efb856 f1c25a f4ce63 f7da74 fae68a fcf0a2 fef8b8 fffecb "
    ),
    "OSLO": (
        "010101 050a10 0a121b 0d1824 0e1e2e 0f2439 112b44 13324f 15395b 194067 1c4873 214f80 "
        "26578c 2e5f99 3767a6 4371b2 507bbc 5c84c3 688cc7 7393c9 7d99ca 869fca 90a5c9 99abc9 "
        "a3b1ca adb8cb b8bfcd c3c8d1 cfd2d8 dbdde0 e8e9ea f4f4f5 ffffff "
    ),
    "CET_L1": (
        "000000 0b0b0b 141414 1a1a1a 212121 272727 2e2e2e 353535 3b3c3c 434343 4a4a4a 515151 "
        "595959 606060 686868 707070 777777 7f7f7f 878787 909090 989898 a0a0a0 a8a8a8 b1b1b1 "
        "b9b9b9 c2c2c2 cbcbcb d3d3d3 dcdcdc e5e5e5 eeeeee f7f7f7 ffffff "
    ),
    "TURBO": (
        "30123b 392a73 4040a2 4456c7 466be3 4680f6 4294ff 37a8fa 28bceb 1ccdd8 18ddc2 1fe9af "
        "32f298 4ef97d 6dfe62 8bff4b a4fc3c b9f635 cdec34 dfdf37 eecf3a f8be39 fdac34 fe962b "
        "fb7e21 f46617 eb500e df3f08 d02f05 be2102 a91601 920b01 7a0403 "
    ),
    "COOLWARM": (
        "3b4cc0 445acc 4e68d8 5875e1 6282ea 6c8ff1 779af7 82a6fb 8db0fe 98b9ff a3c2fe aec9fc "
        "b9d0f9 c3d5f4 ccd9ed d5dbe5 dddcdc e5d8d1 ecd3c5 f1ccb8 f5c4ac f7ba9f f7b093 f6a586 "
        "f4987a f08b6e eb7d62 e46e56 dd5f4b d44e41 ca3b37 be242e b40426 "
    ),
    "VIK": (
        "001261 021f69 022b71 023779 034481 055189 0c5e92 1c6d9c 307da6 488db2 619ebd 7aaec8 "
        "94bed2 adcddd c6dbe6 dee6e9 ece5e0 eed9cd e9cab8 e2baa2 dbaa8d d59b79 cf8c66 c97e53 "
        "c27041 bc622f b2511d a33e0d 912d06 811f06 731406 650907 590008 "
    ),
    "BERLIN": (
        "9eb0ff 8caef6 79abed 65a7e2 519fd3 4194c1 3685ad 2e7699 286886 225973 1d4b61 183d4f "
        "14303e 11242e 111a20 121214 190c09 220c02 2b0e01 351000 411201 4d1602 5b1d08 6c2711 "
        "7d341e 8e422e 9e513f ae6051 be6f63 ce7f76 df8f89 f09f9c ffadad "
    ),
    "ROMA": (
        "7e1700 862c06 8f3c0c 964b12 9d5818 a3651e a97223 b07f2a b68c32 bd9b3c c4aa4a cbba5d "
        "d0ca72 d2d78a d1e2a1 cbe8b4 c0eac3 b1e9ce 9fe4d4 8bdcd7 76d1d7 62c4d4 51b7d0 43a9cb "
        "389cc6 308fc1 2b82bb 2676b6 2269b0 1d5bab 184da4 0f3f9e 033198 "
    ),
    "TWILIGHT": (
        "e2d9e2 d6d7dd c2ced4 aac2cc 94b4c6 80a6c3 7296c1 6786be 6275ba 5f63b5 5e50ac 5d3ca0 "
        "592a8e 511b76 44135b 381144 301436 3b113b 4c1342 61184a 751e4f 892850 993650 a74650 "
        "b35852 bc6a59 c37e64 c89174 cca58b d2b7a5 d9c8c0 dfd5d7 e2d9e2 "
    ),
    "ROMAO": (
        "733957 79384c 7e3942 843d3a 8b4433 924d2f 99582c a2662c aa752f b48636 bd9842 c6aa52 "
        "cfbc66 d4cb7b d6d790 d3dea3 cbe1b3 bfe1bf afdcc8 9dd5cd 8bcbcf 78bece 68b1cb 5ca2c6 "
        "5393bf 4f84b7 4f75ac 53669f 595891 604c81 674372 6d3d64 723959 "
    ),
    "CET_C6": (
        "f7371a f85008 fc7401 ff9500 ffb300 f9cb00 e1d100 bfc700 99b800 72a903 4c9c12 319b2d "
        "2ca751 31ba79 32cfa1 2ce1ca 25e8eb 2bdcfb 31c5ff 2facff 2894ff 3583ff 5e82ff 898fff "
        "aea1ff d0b3ff eebffa ffb9de ffa2b4 ff8589 ff655e fc4438 f7361d "
    ),
    "TAB10": "1f77b4 ff7f0e 2ca02c d62728 9467bd 8c564b e377c2 7f7f7f bcbd22 17becf",
    "OKABE_ITO": "e69f00 56b4e9 009e73 f0e442 0072b2 d55e00 cc79a7",
}
