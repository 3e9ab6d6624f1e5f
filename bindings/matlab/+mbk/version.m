function text = version()
% mbk.version  The version of mbk: '0.1.0'.
  text = mbk_mex('version');
end
